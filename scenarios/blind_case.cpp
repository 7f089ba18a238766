#include "scenarios/blind_case.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/diagnosis/case_folder.hpp"
#include "core/model/arm_model.hpp"
#include "scenarios/child.hpp"
#include "scenarios/concealed/concealed_case.hpp"
#include "scenarios/regression/regression.hpp"
#include "scenarios/scoring/held_out.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::chrono::minutes kPatience{15};  // with one diagnosis
constexpr int kLook_ms = 50;                   // between looks at the stop flag

/// What somebody said of a case.
struct Reply {
  Json answer{};          ///< null: there is none
  std::string failure{};  ///< why
};

/// Runs a program to its end. @returns the exit code and the last line it printed; nothing when a
/// stop was asked for.
struct Ended {
  int exit_code = 0;
  std::string last_line{};
};
std::optional<Ended> run_to_end(Child& child, const std::atomic<bool>& stop) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  Ended ended;
  for (;;) {
    if (stop) return std::nullopt;
    if (std::chrono::steady_clock::now() > end) {
      child.ask_to_end();
      return Ended{.exit_code = child.end(2000), .last_line = "it took too long"};
    }
    if (const auto line = child.next_line(kLook_ms)) ended.last_line = *line;
    if (const auto code = child.exit_code()) {
      while (const auto line = child.next_line(kLook_ms)) {
        ended.last_line = *line;
      }
      ended.exit_code = *code;
      return ended;
    }
  }
}

std::string last_line_of(const fs::path& file) {
  std::ifstream in{file};
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

std::string last_words(const fs::path& errors, const Ended& ended) {
  const std::string said = last_line_of(errors);
  return fmt::format("exit code {}: {}", ended.exit_code, said.empty() ? ended.last_line : said);
}

/// One case at work: where its files are.
class BlindCase {
 public:
  BlindCase(const BlindWork& work, std::size_t index)
      : work_{work},
        index_{index},
        name_{fmt::format("case-{:04}", index + 1)},
        folder_{work.store.case_folder() / name_},
        errors_{work.store.case_folder() / (name_ + ".stderr")} {}

  bool run() {
    fs::remove_all(folder_);
    if (!conceal()) return false;
    const std::optional<Reply> diagnosis = diagnose();
    if (!diagnosis || work_.stop) return false;
    const auto [plain, correlated] = regress_both();
    if (work_.stop) return false;
    open({{"diagnosis", *diagnosis}, {"bic", plain}, {"bic_correlated", correlated}});
    if (!work_.keep) fs::remove_all(folder_);
    fs::remove(errors_);
    return true;
  }

 private:
  bool conceal() {
    const std::string number = std::to_string(work_.plan.cases);
    Child child{
        "teleop_conceal",
        {sibling_program("teleop_conceal"), work_.plan.nulls ? "--nulls" : "--cases", number,
         "--seed", std::to_string(work_.plan.seed), "--shard",
         fmt::format("{}/{}", index_ + 1, number), "--out", work_.store.case_folder().string()},
        errors_.string()};
    const std::optional<Ended> ended = run_to_end(child, work_.stop);
    if (!ended) return false;
    if (ended->exit_code != 0) {
      throw Error{fmt::format("{}: teleop_conceal: {}", name_, last_words(errors_, *ended))};
    }
    work_.store.publish(name_, ended->last_line);
    return true;
  }

  [[nodiscard]] std::optional<Reply> diagnose() const {
    const fs::path file = folder_ / "answer.json";
    Child child{
        "diagnose",
        {work_.diagnose, "diagnose", folder_.string(), "--json", file.string(), "--threads", "1"},
        errors_.string()};
    const std::optional<Ended> ended = run_to_end(child, work_.stop);
    if (!ended) return std::nullopt;
    if (ended->exit_code != 0) return Reply{.failure = last_words(errors_, *ended)};
    std::ifstream in{file};
    Reply reply{.answer = Json::parse(in, nullptr, false)};
    if (reply.answer.is_discarded()) return Reply{.failure = "the answer is not JSON"};
    return reply;
  }

  [[nodiscard]] std::pair<Reply, Reply> regress_both() const {
    try {
      const DiagnosisCase data = read_case(folder_);
      const Design design{data, load_arm(data.plant)};
      return {{.answer = regress(design, data, Counting::samples)},
              {.answer = regress(design, data, Counting::correlated)}};
    } catch (const Error& error) {
      return {{.failure = error.what()}, {.failure = error.what()}};
    }
  }

  void open(const std::vector<std::pair<std::string, Reply>>& replies) {
    const concealed::ConcealedCase drawn = concealed::draw_case(work_.plan, index_);
    const Json truth = Json::parse(concealed::truth_json(drawn));
    Json line{{"index", index_}, {"case", name_}, {"truth", truth}, {"answers", Json::object()}};
    for (const auto& [who, reply] : replies) {
      Json entry{{"answer", reply.answer}};
      if (!reply.failure.empty()) entry["failure"] = reply.failure;
      if (!reply.answer.is_null()) {
        entry["held_out_over_true"] = held_out_over_true(drawn, reply.answer);
      }
      line["answers"][who] = std::move(entry);
    }
    work_.store.add(index_, line.dump());
  }

  const BlindWork& work_;
  std::size_t index_;
  std::string name_;
  fs::path folder_;
  fs::path errors_;
};

}  // namespace

bool do_blind_case(const BlindWork& work, std::size_t index) {
  return BlindCase{work, index}.run();
}

}  // namespace teleop
