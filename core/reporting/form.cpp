#include "core/reporting/form.hpp"

#include "core/base/contract.hpp"
#include "core/reporting/escape.hpp"

namespace teleop {

std::string fill_form(std::string_view form,
                      const std::map<std::string, std::string, std::less<>>& places) {
  std::string out;
  while (true) {
    const std::size_t begin = form.find("{{");
    if (begin == std::string_view::npos) return out.append(form);
    const std::size_t end = form.find("}}", begin);
    expects(end != std::string_view::npos, "a place in the page ends");
    const auto place = places.find(form.substr(begin + 2, end - begin - 2));
    expects(place != places.end(), "every place in the page is filled");
    out.append(form.substr(0, begin)).append(place->second);
    form.remove_prefix(end + 2);
  }
}

std::string sentence_html(const std::string& sentence) {
  std::string out;
  bool after_digit = false;
  for (const char c : escape_html(sentence)) {
    if (after_digit && c == ' ') {
      out += "&nbsp;";
    } else {
      out += c;
    }
    // \xb1: the second half of ±
    after_digit = ('0' <= c && c <= '9') || c == '\xb1';
  }
  return out;
}

}  // namespace teleop
