#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace teleop {

/// The numbers that a setting may have, ends included.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

inline constexpr Range kAny{};
inline constexpr Range kNotNegative{.low = 0.0};
inline constexpr Range kPositive{.low = std::numeric_limits<double>::min()};

/// One named value of a configuration, bound to the variable that it sets.
struct Setting {
  using Target =
      std::variant<bool*, int*, std::uint64_t*, double*, std::string*, std::array<double, 3>*>;
  std::string key;   ///< dotted, with the unit in the name: "law.stiffness_N_per_m"
  std::string text;  ///< what it is, one line, for --help and --print-config
  Target target{};
  Range range{};
  std::string origin = "default";  ///< "default", "pair.toml:7", "command line"

  [[nodiscard]] std::string value() const;  ///< as TOML
};

/// A configuration as a flat list of settings: filled from TOML files and the command line, checked
/// on the way in, printed with units and origins. A struct adds its fields once, in a free function
/// `add_settings(Settings&, const std::string& prefix, Config&)`, and every program and file format
/// picks them up from here.
///
/// The list refers to the structs: they must outlive it and must not move.
class Settings {
 public:
  /// @pre key is new.
  void add(std::string key, Setting::Target target, std::string text, Range range = kAny);

  /// Reads a TOML file; later values win.
  /// @throws ConfigError naming file, line and key: unreadable, not TOML, unknown key, wrong type,
  ///         out of range.
  void load(const std::filesystem::path& file);

  /// The same for TOML text; `name` stands for the file in messages. Keys and tables that
  /// are named in `others`, dotted, belong to another reader and are passed over.
  void load_text(std::string_view toml,
                 const std::string& name,
                 std::span<const std::string_view> others = {});

  /// Sets one value from text as TOML would write it (strings may stay bare).
  /// @throws ConfigError naming the origin and the key.
  void set(const std::string& key, const std::string& text, const std::string& origin);

  /// Every value as TOML that load() accepts, grouped in tables, with meaning and origin as
  /// comments.
  [[nodiscard]] std::string print() const;

  [[nodiscard]] const std::vector<Setting>& list() const noexcept { return settings_; }

 private:
  [[nodiscard]] Setting& find(const std::string& key, const std::string& place);

  std::vector<Setting> settings_;
};

/// The file `name` of the data folder (arms, plants, catalogue): in $TELEOP_DATA, beside the
/// installed program, or in the source tree, in that order. A path that exists is returned as it
/// is.
/// @throws ConfigError when it is nowhere, naming the places looked at.
[[nodiscard]] std::filesystem::path data_file(const std::filesystem::path& name);

}  // namespace teleop
