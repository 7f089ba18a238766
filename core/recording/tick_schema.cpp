#include <array>
#include <type_traits>

#include <google/protobuf/descriptor.pb.h>

#include "core/recording/tick_codec.hpp"

namespace teleop {
namespace {

using google::protobuf::DescriptorProto;
using google::protobuf::FieldDescriptorProto;
using google::protobuf::FileDescriptorProto;

FieldDescriptorProto::Type type_of(std::uint64_t) { return FieldDescriptorProto::TYPE_UINT64; }
FieldDescriptorProto::Type type_of(std::uint32_t) { return FieldDescriptorProto::TYPE_UINT32; }
FieldDescriptorProto::Type type_of(std::int64_t) { return FieldDescriptorProto::TYPE_INT64; }
FieldDescriptorProto::Type type_of(double) { return FieldDescriptorProto::TYPE_DOUBLE; }
FieldDescriptorProto::Type type_of(const std::array<std::int32_t, kJoints>&) {
  return FieldDescriptorProto::TYPE_SINT32;
}
FieldDescriptorProto::Type type_of(const Vector3&) { return FieldDescriptorProto::TYPE_DOUBLE; }

/// Before file.message_type[0].field[index], which stands on a line of its own.
void add_comment(google::protobuf::SourceCodeInfo& info, int index, const std::string& text) {
  auto& location = *info.add_location();
  const std::array<int, 4> path{FileDescriptorProto::kMessageTypeFieldNumber, 0,
                                DescriptorProto::kFieldFieldNumber, index};
  const std::array<int, 3> line_and_columns{index, 0, 1};
  location.mutable_path()->Add(path.begin(), path.end());
  location.mutable_span()->Add(line_and_columns.begin(), line_and_columns.end());
  location.set_leading_comments(" " + text + "\n");
}

}  // namespace

std::string tick_schema() {
  google::protobuf::FileDescriptorSet set;
  auto& file = *set.add_file();
  file.set_name("teleop/tick.proto");
  file.set_package("teleop");
  file.set_syntax("proto3");
  auto& message = *file.add_message_type();
  message.set_name("Tick");

  const TickRecord record;
  for_each_field(record, [&](const Field& field, const auto& value) {
    add_comment(*file.mutable_source_code_info(), message.field_size(), field.text);
    auto& entry = *message.add_field();
    entry.set_name(field.name);
    entry.set_number(field.number);
    entry.set_type(type_of(value));
    entry.set_label(std::is_arithmetic_v<std::remove_cvref_t<decltype(value)>>
                        ? FieldDescriptorProto::LABEL_OPTIONAL
                        : FieldDescriptorProto::LABEL_REPEATED);
  });
  return set.SerializeAsString();
}

}  // namespace teleop
