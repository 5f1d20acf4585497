// A page served on loopback under an address that nobody can guess. The only file that touches
// cpp-httplib is local_server.cpp.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

namespace hookeye {

struct ServerOptions {
  std::string host = "127.0.0.1";
  int port = 0;  ///< 0: any free one
};

struct WebRequest {
  std::string body;
  std::function<std::string(const std::string& name)> parameter;  ///< of the address; "": none
};

struct WebAnswer {
  int status = 200;
  std::string body;
  std::string type = "application/json";
  std::string saved_as;  ///< name under which a browser saves it; empty: it shows it
};
WebAnswer answer_json(const nlohmann::json& document);
WebAnswer refusal(int status, const std::string& why);

/// What a file is locked for, in words: "a studio", "run".
struct ServedThing {
  std::filesystem::path lock;   ///< holds the address while it is served
  std::filesystem::path named;  ///< as the user named it
  std::string server = "a studio", thing = "run", short_name = "studio";
};

/// Answers only under this machine's own name (so that no other site can be pointed at its port),
/// only with the token, and takes changes only from its own page.
class LocalServer {
 public:
  using Handler = std::function<WebAnswer(const WebRequest&)>;

  /// Locks; the kernel drops the lock with the process. Throws InputError where another process
  /// serves the same, and where the host stands for all addresses of the machine.
  LocalServer(ServedThing served, const ServerOptions& options, size_t largest_request);
  ~LocalServer();
  /// What throws an InputError is answered with 400 and its words, all else with 500.
  void get(const std::string& name, Handler handler);
  void post(const std::string& name, Handler handler);
  /// Takes the port; call it when all handlers are there. Throws InputError where it is taken.
  void open();
  std::string address() const;
  /// Serves until interrupted(); then calls `ended`, and returns when the last request is answered.
  void run(const std::function<void()>& ended);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hookeye
