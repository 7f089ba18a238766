#pragma once

#include <filesystem>
#include <string>

namespace teleop {

/// The folder of that name, made when it is not there; "" is the working directory.
/// @throws ConfigError when it cannot be made.
[[nodiscard]] std::filesystem::path make_folder(const std::string& name);

/// Writes a text file whole. @throws ConfigError when it cannot be written.
void write_text(const std::filesystem::path& file, const std::string& text);

/// Writes `script` as NAME.gp into a folder and runs gnuplot on it there. What goes wrong is said
/// on stderr. @returns whether it was drawn.
[[nodiscard]] bool draw_with_gnuplot(const std::filesystem::path& folder,
                                     const std::string& name,
                                     const std::string& script);

/// Text between double quotes of a gnuplot script, shown as it is.
[[nodiscard]] std::string gnuplot_text(const std::string& text);

}  // namespace teleop
