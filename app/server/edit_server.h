// A capture in the browser, served live on loopback.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "app/server/local_server.h"

namespace hookeye {

/// Serves `capture` (the yaml file or its folder; it may have faults) until interrupted(). `ready`
/// is told the address. Throws InputError where there is no such file, another editor is open on
/// it, or the port is taken.
void serve_editor(const std::filesystem::path& capture, const ServerOptions& options,
                  const std::function<void(const std::string& address)>& ready);

}  // namespace hookeye
