// The page served live on loopback. The only file that touches cpp-httplib is studio_server.cpp.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace hookeye {

struct StudioOptions {
  std::string host = "127.0.0.1";
  int port = 0;  ///< 0: any free one
};

/// Serves the run until interrupted(). `ready` is told the address, which holds an unguessable
/// token. Throws InputError when another studio is open on this run, the port is taken, or the host
/// stands for all addresses of the machine.
void serve_studio(const std::filesystem::path& run, const StudioOptions& options,
                  const std::function<void(const std::string& address)>& ready);

}  // namespace hookeye
