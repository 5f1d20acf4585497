// The page of a run served live on loopback.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "app/server/local_server.h"

namespace hookeye {

/// Serves the run until interrupted(). `ready` is told the address, which holds an unguessable
/// token. Throws InputError when another studio is open on this run, the port is taken, or the host
/// stands for all addresses of the machine.
void serve_studio(const std::filesystem::path& run, const ServerOptions& options,
                  const std::function<void(const std::string& address)>& ready);

}  // namespace hookeye
