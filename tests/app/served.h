// A verb that serves a page, asked from outside.
#pragma once

#include <arpa/inet.h>
#include <signal.h>
#include <sys/socket.h>

#include <chrono>
#include <thread>

#include "app/cli.h"

namespace hookeye::test {

/// `hookeye VERB THING`, ended with the object.
class Served {
 public:
  Served(const fs::path& folder, const char* verb, const char* thing) {
    const fs::path out = folder / (std::string(verb) + ".txt");
    process_ = ::fork();
    if (process_ == 0) {
      if (::chdir(folder.c_str()) != 0 || !std::freopen(out.c_str(), "w", stdout) ||
          !std::freopen("/dev/null", "w", stderr))
        ::_exit(1);
      ::execl(HOOKEYE_PROGRAM, HOOKEYE_PROGRAM, verb, thing, nullptr);
      ::_exit(1);
    }
    for (int i = 0; i < 600 && !ready(); ++i) {
      const std::string said = read(out), scheme = "http://127.0.0.1:";
      const size_t at = said.find(scheme), slash = said.find('/', at + scheme.size());
      if (said.rfind("/\n") != std::string::npos && slash != std::string::npos) {
        port_ = std::stoi(said.substr(at + scheme.size()));
        root_ = said.substr(slash, said.find('\n', slash) - slash);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }
  ~Served() {
    if (process_ > 0) interrupt();
  }
  bool ready() const { return port_ > 0; }
  pid_t process() const { return process_; }
  /// Status as waitpid() has it.
  int interrupt() {
    int status = -1;
    ::kill(process_, SIGINT);
    ::waitpid(process_, &status, 0);
    process_ = -1;
    return status;
  }

  struct Answer {
    int status = 0;
    std::string body;
  };
  Answer get(const std::string& what) const { return ask("GET", what, ""); }
  Answer post(const std::string& what, const std::string& body) const {
    return ask("POST", what, body);
  }
  /// As a page of another site would.
  Answer post_from_elsewhere(const std::string& what, const std::string& body) const {
    return ask("POST", what, body, "http://example.org");
  }

 private:
  Answer ask(const std::string& method, const std::string& what, const std::string& body,
             const std::string& from = "") const {
    const std::string host = "127.0.0.1:" + std::to_string(port_);
    const std::string origin = from.empty() ? "http://" + host : from;
    const std::string request =
        method + " " + root_ + what + " HTTP/1.1\r\nHost: " + host + "\r\nOrigin: " + origin +
        "\r\nConnection: close\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" +
        body;
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<uint16_t>(port_));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int connection = ::socket(AF_INET, SOCK_STREAM, 0);
    std::string all;
    if (::connect(connection, reinterpret_cast<sockaddr*>(&to), sizeof to) == 0 &&
        ::send(connection, request.data(), request.size(), 0) ==
            static_cast<ssize_t>(request.size())) {
      char part[4096];
      for (ssize_t n; (n = ::recv(connection, part, sizeof part, 0)) > 0;) all.append(part, n);
    }
    ::close(connection);
    const size_t end = all.find("\r\n\r\n");
    if (all.size() < 12 || end == std::string::npos) return {};
    return {std::stoi(all.substr(9, 3)), all.substr(end + 4)};
  }

  pid_t process_ = -1;
  int port_ = 0;
  std::string root_;
};

}  // namespace hookeye::test
