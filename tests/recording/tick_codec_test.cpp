#include "core/recording/tick_codec.hpp"

#include <memory>
#include <set>
#include <string>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <gtest/gtest.h>

#include "tests/recording/samples.hpp"

namespace teleop {
namespace {

namespace pb = google::protobuf;

/// Protobuf's own idea of the message, made of nothing but the embedded schema.
class Reference {
 public:
  Reference() {
    pb::FileDescriptorSet set;
    EXPECT_TRUE(set.ParseFromString(tick_schema()));
    EXPECT_EQ(set.file_size(), 1);
    const pb::FileDescriptor* file = pool_.BuildFile(set.file(0));
    EXPECT_NE(file, nullptr);
    if (file != nullptr) type_ = file->pool()->FindMessageTypeByName(kTickMessage);
    EXPECT_NE(type_, nullptr);
  }

  [[nodiscard]] const pb::Descriptor& type() const { return *type_; }
  [[nodiscard]] std::unique_ptr<pb::Message> message() {
    return std::unique_ptr<pb::Message>{factory_.GetPrototype(type_)->New()};
  }

 private:
  pb::DescriptorPool pool_;
  pb::DynamicMessageFactory factory_;
  const pb::Descriptor* type_ = nullptr;
};

/// Puts a record's fields into Protobuf's message by their names.
class SetByName {
 public:
  explicit SetByName(pb::Message& message) : message_{message} {}

  void operator()(const Field& field, std::uint64_t value) const {
    reflection().SetUInt64(&message_, named(field), value);
  }
  void operator()(const Field& field, std::uint32_t value) const {
    reflection().SetUInt32(&message_, named(field), value);
  }
  void operator()(const Field& field, std::int64_t value) const {
    reflection().SetInt64(&message_, named(field), value);
  }
  void operator()(const Field& field, double value) const {
    reflection().SetDouble(&message_, named(field), value);
  }
  void operator()(const Field& field, const std::array<std::int32_t, kJoints>& values) const {
    for (const std::int32_t value : values) {
      reflection().AddInt32(&message_, named(field), value);
    }
  }
  void operator()(const Field& field, const Vector3& values) const {
    for (const double value : values) {
      reflection().AddDouble(&message_, named(field), value);
    }
  }

 private:
  [[nodiscard]] const pb::Reflection& reflection() const { return *message_.GetReflection(); }
  [[nodiscard]] const pb::FieldDescriptor* named(const Field& field) const {
    return message_.GetDescriptor()->FindFieldByName(field.name);
  }
  pb::Message& message_;
};

std::string serialized(const pb::Message& message) {
  std::string text;
  pb::io::StringOutputStream stream{&text};
  pb::io::CodedOutputStream coded{&stream};
  coded.SetSerializationDeterministic(true);
  EXPECT_TRUE(message.SerializeToCodedStream(&coded));
  coded.Trim();
  return text;
}

std::string encoded(const TickRecord& record) {
  Bytes bytes;
  encode_tick(record, bytes);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(TickSchema, DeclaresEveryFieldWithItsNumberAndMeaning) {
  Reference reference;
  TickRecord record;
  std::set<int> numbers;
  for_each_field(record, [&](const Field& field, const auto&) {
    const pb::FieldDescriptor* found = reference.type().FindFieldByName(field.name);
    ASSERT_NE(found, nullptr) << field.name;
    EXPECT_EQ(found->number(), field.number) << field.name;
    EXPECT_TRUE(numbers.insert(field.number).second) << field.name << ": number used twice";
    pb::SourceLocation comment;
    ASSERT_TRUE(found->GetSourceLocation(&comment)) << field.name;
    EXPECT_EQ(comment.leading_comments, std::string{" "} + field.text + "\n");
  });
  EXPECT_EQ(reference.type().field_count(), static_cast<int>(numbers.size()));
}

TEST(TickCodec, WritesTheBytesThatProtobufWrites) {
  Reference reference;
  Random random{1};
  for (int i = 0; i < testing::cases(1000); ++i) {
    const TickRecord record = testing::any_tick(random);
    const auto message = reference.message();
    for_each_field(record, SetByName{*message});

    ASSERT_EQ(encoded(record), serialized(*message)) << "case " << i;
  }
}

TEST(TickCodec, ReadsBackWhatItWroteBitForBit) {
  Random random{2};
  for (int i = 0; i < testing::cases(1000); ++i) {
    const TickRecord record = testing::any_tick(random);

    const auto read = decode_tick(bytes_of(encoded(record)));

    ASSERT_TRUE(read.has_value());
    ASSERT_EQ(testing::bits_of(*read), testing::bits_of(record)) << "case " << i;
  }
}

TEST(TickCodec, TakesAMissingFieldForZero) {
  const auto read = decode_tick({});

  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(testing::bits_of(*read), testing::bits_of(TickRecord{}));
}

TEST(TickCodec, ReadsALogFromBeforeTheAccelerometer) {
  TickRecord record = testing::any_ticks(5, 1).front();
  record.tool_acceleration_m_per_s2.setZero();
  std::string message = encoded(record);
  constexpr std::size_t kField = 2 + 1 + 3 * sizeof(double);  // tag 45, length, three numbers
  message.resize(message.size() - kField);                    // fields stand in their order

  const auto read = decode_tick(bytes_of(message));

  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(testing::bits_of(*read), testing::bits_of(record));
}

TEST(TickCodec, IgnoresFieldsThatItDoesNotKnow) {
  const TickRecord record = testing::plain_tick(7);
  std::string message = encoded(record);
  pb::UnknownFieldSet unknown;
  unknown.AddVarint(5000, 1);
  unknown.AddFixed32(5001, 2);
  unknown.AddFixed64(5002, 3);
  unknown.AddLengthDelimited(5003, "text");
  unknown.AddVarint(18, 4);  // p_m, of another type
  std::string foreign;
  ASSERT_TRUE(unknown.SerializeToString(&foreign));
  message.insert(0, foreign);

  const auto read = decode_tick(bytes_of(message));

  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(testing::bits_of(*read), testing::bits_of(record));
}

TEST(TickCodec, ReadsNoFieldPastTheEndOfATornMessage) {
  const std::string message = encoded(testing::any_ticks(3, 1).front());
  Reference reference;
  for (std::size_t size = 0; size < message.size(); ++size) {
    const std::string torn = message.substr(0, size);
    EXPECT_EQ(decode_tick(bytes_of(torn)).has_value(), reference.message()->ParseFromString(torn))
        << "cut at " << size;
  }
}

TEST(TickCodec, SurvivesBytesThatAreNoMessage) {
  Random random{4};
  for (int i = 0; i < testing::cases(20'000); ++i) {
    std::string noise(random.bits() % 64, '\0');
    for (char& byte : noise) {
      byte = static_cast<char>(random.bits());
    }
    static_cast<void>(decode_tick(bytes_of(noise)));
  }
}

}  // namespace
}  // namespace teleop
