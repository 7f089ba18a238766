#include "core/reporting/html.hpp"

#include <fstream>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/math/random.hpp"
#include "core/reporting/escape.hpp"
#include "core/reporting/page.hpp"
#include "tests/reporting/run_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::log_of;
using testing::set;
using testing::set_tool_force;
using testing::sine;
using testing::TemporaryFolder;

std::vector<Log> a_pair(double seconds = 2.0) {
  const auto change = [](TickRecord& r, double t) {
    set_tool_force(r, Vector3{1.0, 0.0, 0.0});
    r.coupling_N = Vector3{0.0, std::sin(t), 0.0};
    r.lateness_us = 5.0;
    r.round_trip_us = 60.0;
    r.peer_age_ms = 0.5;
    if (t > 1.0) set(r, Limit::force);
    if (t > 1.5) r.fault = 1;
    if (t > 1.5) set(r, Mode::faulted);
  };
  return {log_of({.role = Role::master,
                  .seconds = seconds,
                  .position = sine(0.05, 1.0),
                  .change = change}),
          log_of({.role = Role::slave,
                  .seconds = seconds,
                  .position = sine(0.05, 1.0, 0.003),
                  .change = change})};
}

std::string page_of(const std::vector<Log>& logs) { return report_page(logs, measure(logs)); }

json data_of(const std::string& page) {
  const std::string begin = "<script type=\"application/json\" id=\"data\">";
  const std::size_t from = page.find(begin) + begin.size();
  return json::parse(page.substr(from, page.find("</script>", from) - from));
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++n;
  }
  return n;
}

std::map<std::string, std::vector<std::string>> labels_of(const json& data) {
  std::map<std::string, std::vector<std::string>> labels;
  for (const json& chart : data["charts"]) {
    for (const json& series : chart["series"]) {
      labels[chart["id"]].push_back(series["label"]);
    }
  }
  return labels;
}

TEST(EscapeHtml, LeavesNothingThatHtmlReads) {
  EXPECT_EQ(escape_html("<a href=\"x\">'&amp;"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;amp;");
}

TEST(ReportPage, NeedsNothingButItself) {
  const std::string page = page_of(a_pair());
  for (const char* reference : {"http://", "https://", "<link", "<iframe", " src=\"", " href=\"",
                                "@import", "url(", "sourceMappingURL"}) {
    EXPECT_EQ(page.find(reference), std::string::npos) << reference;
  }
  EXPECT_NE(page.find("Content-Security-Policy"), std::string::npos);
}

TEST(ReportPage, ClosesWhatItOpensAndFillsEveryPlace) {
  const std::string page = page_of(a_pair());
  EXPECT_EQ(page.rfind("<!doctype html>", 0), 0U);
  const std::string form{page::form};
  for (std::size_t at = form.find("{{"); at != std::string::npos; at = form.find("{{", at + 2)) {
    const std::string place = form.substr(at, form.find("}}", at) + 2 - at);
    EXPECT_EQ(page.find(place), std::string::npos) << place;
  }
  const std::string body =
      page.substr(page.find("<body>"), page.find("<script") - page.find("<body>"));
  for (const char* tag :
       {"header", "section", "table", "tr", "td", "th", "ul", "li", "dl", "div", "details", "p"}) {
    const std::string name{tag};
    EXPECT_EQ(count(body, "<" + name + ">") + count(body, "<" + name + " "),
              count(body, "</" + name + ">"))
        << tag;
  }
  EXPECT_EQ(count(page, "<script"), count(page, "</script>"));
}

TEST(ReportPage, HasEverySeriesOfBothSides) {
  const json data = data_of(page_of(a_pair()));
  auto labels = labels_of(data);
  const std::vector<std::string> axes{"master x", "master y", "master z",
                                      "slave x",  "slave y",  "slave z"};
  const std::vector<std::string> sides{"master", "slave"};
  EXPECT_EQ(labels["position"], axes);
  EXPECT_EQ(labels["coupling"], axes);
  EXPECT_EQ(labels["tool-force"], axes);
  EXPECT_EQ(labels["error"], (std::vector<std::string>{"|e|", "x", "y", "z"}));
  EXPECT_EQ(labels["power"].size(), 4U);
  EXPECT_EQ(labels["energy"].size(), 4U);
  EXPECT_EQ(labels["lateness"], sides);
  EXPECT_EQ(labels["round-trip"], sides);
  EXPECT_EQ(labels["age"].size(), 4U);
  ASSERT_EQ(data["histograms"].size(), 3U);
  for (const json& histogram : data["histograms"]) {
    ASSERT_EQ(histogram["series"].size(), 2U) << histogram["title"];
    std::uint64_t counted = 0;
    for (const json& n : histogram["series"][0]["counts"]) {
      counted += n.get<std::uint64_t>();
    }
    EXPECT_GT(counted, 0U);
  }
}

TEST(ReportPage, GivesEverySeriesTwoPointsABucketAndMarksModesLimitsAndFaults) {
  const json data = data_of(page_of(a_pair()));
  const std::size_t buckets = data["buckets"];
  EXPECT_EQ(buckets, 1001U);
  for (const json& chart : data["charts"]) {
    for (const json& series : chart["series"]) {
      EXPECT_EQ(series["values"].size(), 2 * buckets);
    }
  }
  ASSERT_EQ(data["modes"]["slave"].size(), 2U);
  EXPECT_EQ(data["modes"]["slave"][0][2], 2);
  EXPECT_EQ(data["modes"]["slave"][1][2], 4);
  ASSERT_EQ(data["limits"]["master"].size(), 1U);
  EXPECT_EQ(data["limits"]["master"][0][2], 1);
  EXPECT_EQ(data["faults"].size(), 2U);
  EXPECT_EQ(data["faults"][0]["name"], "device_unplugged");
}

TEST(ReportPage, OfOneSideShowsThePeerAsReceived) {
  std::vector<Log> logs = a_pair();
  logs.erase(logs.begin());
  auto labels = labels_of(data_of(page_of(logs)));
  EXPECT_EQ(labels["position"].size(), 6U);
  EXPECT_EQ(labels["position"].back(), "master as received z");
  EXPECT_EQ(labels["error"], (std::vector<std::string>{"slave"}));
}

TEST(ReportPage, CannotBeBrokenOutOfByMetadata) {
  const std::string evil =
      "</td></script><script>alert(1)</script><img src=x onerror=alert(1)>{{data}}\"'&";
  std::vector<Log> logs = a_pair(0.1);
  const std::size_t scripts = count(page_of(logs), "<script");
  for (Log& log : logs) {
    log.complete = false;
    log.damage = evil;
    log.file = evil;
    for (const char* key : {"arm", "hand", "environment", "seed", "version", "config", "device"}) {
      log.metadata[key] = evil;
    }
    log.metadata[evil] = "a\nb" + evil;
  }

  const std::string page = page_of(logs);

  EXPECT_EQ(count(page, "<script"), scripts);
  EXPECT_EQ(page.find("<img"), std::string::npos);
  EXPECT_EQ(page.find("alert(1)<"), std::string::npos);
  EXPECT_NE(page.find("&lt;script&gt;alert(1)&lt;/script&gt;"), std::string::npos);
  EXPECT_NE(page.find("{{data}}&quot;&#39;&amp;"), std::string::npos) << "shown as it was written";
  EXPECT_EQ(data_of(page)["charts"].size(), 9U);
}

TEST(ReportPage, OfTenMinutesStaysSmall) {
  Random random{1};
  const auto noisy = [&](TickRecord& r, double) {
    r.p_m = Vector3{random.normal(), random.normal(), random.normal()};
    r.coupling_N = r.p_m;
    r.v_m_per_s = r.p_m;
    r.error_m = r.p_m;
    r.peer_age_ms = r.peer_age_bound_ms = random.uniform();
    r.round_trip_us = r.lateness_us = random.uniform();
    r.energy_J = random.normal();
    set_tool_force(r, r.p_m);
    if (random.uniform() < 0.1) set(r, Limit::overrun);
  };
  const std::vector<Log> logs{
      log_of({.role = Role::master, .seconds = 600.0, .rate_Hz = 100.0, .change = noisy}),
      log_of({.role = Role::slave, .seconds = 600.0, .rate_Hz = 100.0, .change = noisy})};
  EXPECT_LT(page_of(logs).size(), 5'000'000U);
}

TEST(WriteReport, WritesTheWholePageAndReplacesAnOlderOne) {
  const TemporaryFolder folder;
  const std::vector<Log> logs = a_pair(0.1);
  const PairMetrics metrics = measure(logs);
  const fs::path file = folder.path() / "report.html";
  std::ofstream{file} << "older";
  write_report(file, logs, metrics);
  EXPECT_EQ(fs::file_size(file), report_page(logs, metrics).size());
  EXPECT_FALSE(fs::exists(folder.path() / "report.html.part"));
}

TEST(WriteReport, NeverReplacesARecording) {
  const TemporaryFolder folder;
  std::vector<Log> logs = a_pair(0.1);
  logs[1].file = folder.path() / "slave.mcap";
  std::ofstream{logs[1].file} << "recorded";
  fs::create_hard_link(logs[1].file, folder.path() / "other-name.html");
  const PairMetrics metrics = measure(logs);
  EXPECT_THROW(write_report(logs[1].file, logs, metrics), ConfigError);
  EXPECT_THROW(write_report(folder.path() / "." / "slave.mcap", logs, metrics), ConfigError);
  EXPECT_THROW(write_report(folder.path() / "other-name.html", logs, metrics), ConfigError);
  EXPECT_EQ(fs::file_size(logs[1].file), 8U);
}

TEST(WriteReport, ThatFailsIsAClearErrorAndLeavesNothing) {
  const TemporaryFolder folder;
  const std::vector<Log> logs = a_pair(0.1);
  const fs::path file = folder.path() / "no-such-folder" / "report.html";
  try {
    write_report(file, logs, measure(logs));
    FAIL() << "wrote into a folder that is not there";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string{error.what()}.find(file.string()), std::string::npos);
    EXPECT_EQ(std::string{error.what()}.find('\n'), std::string::npos);
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace teleop
