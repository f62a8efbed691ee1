#include <fmt/format.h>

#include "commands.hpp"
#include "shapelight/io/io.hpp"

namespace shapelight::cli {

Command add_formats_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("formats", "List the file formats that can be read and written.");
  return {command, [](std::stop_token) {
            for (const FormatInfo& format : supported_formats()) {
              std::string extensions;
              for (const std::string& e : format.extensions) extensions += fmt::format("{} ", e);
              fmt::print("{:<28}{:<6}{:<7}{}\n", extensions, format.can_read ? "read" : "-",
                         format.can_write ? "write" : "-", format.description);
            }
            return 0;
          }};
}

}  // namespace shapelight::cli
