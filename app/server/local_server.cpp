#include "app/server/local_server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/file.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <thread>

#include "app/interrupt.h"
#include "core/input_error.h"
#include "core/text_file.h"

// Last: it includes resolv.h, whose macro _res breaks Eigen's headers.
#include <httplib.h>

namespace hookeye {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

/// 128 random bits of the system, in hexadecimal.
std::string make_token() {
  unsigned char bytes[16];
  if (::getrandom(bytes, sizeof bytes, 0) != sizeof bytes)
    throw std::runtime_error("the system gives no random numbers");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

/// One server a thing: a file is locked while it is open and holds its address, readable by its
/// owner alone. The kernel drops the lock with the process.
class ServerLock {
 public:
  explicit ServerLock(const ServedThing& served) : file_(served.lock) {
    // Not through a link: the address would be written into what it leads to.
    handle_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (handle_ < 0) return;  // what cannot be written is shown all the same
    if (::flock(handle_, LOCK_EX | LOCK_NB) == 0) return;
    ::close(handle_);
    handle_ = -1;
    std::string where = "in another process";
    try {
      where = "at " + read_text(file_);
    } catch (const std::exception&) {
    }
    throw InputError(
        {served.named.string()},
        fmt::format("{} is open on this {} already, {}", served.server, served.thing, where),
        fmt::format("open that address, or end that {} with Ctrl-C", served.short_name));
  }
  ServerLock(const ServerLock&) = delete;
  ServerLock& operator=(const ServerLock&) = delete;
  ~ServerLock() {
    if (handle_ < 0) return;
    std::error_code ignored;
    fs::remove(file_, ignored);
    ::close(handle_);
  }
  void tell(const std::string& address) const {
    if (handle_ < 0 || ::ftruncate(handle_, 0) != 0) return;
    [[maybe_unused]] const auto written = ::pwrite(handle_, address.data(), address.size(), 0);
  }

 private:
  fs::path file_;
  int handle_ = -1;
};

/// "any address of this machine", in whatever spelling the system takes.
bool is_wildcard(const std::string& host) {
  in_addr v4{};
  in6_addr v6{};
  if (host.empty()) return true;
  if (::inet_aton(host.c_str(), &v4) != 0) return v4.s_addr == htonl(INADDR_ANY);
  if (::inet_pton(AF_INET6, host.c_str(), &v6) != 1) return false;
  const bool mapped = IN6_IS_ADDR_V4MAPPED(&v6) &&
                      std::all_of(v6.s6_addr + 12, v6.s6_addr + 16, [](auto b) { return b == 0; });
  return IN6_IS_ADDR_UNSPECIFIED(&v6) || mapped;
}

/// A server answers under one name alone (guard()), so it must be told one.
const std::string& one_address(const std::string& host) {
  if (is_wildcard(host))
    throw InputError({"--host " + host},
                     "this stands for all addresses of the machine, but the studio answers under "
                     "one, so that no other site can reach it by a name of its own",
                     "tell the address or name that the browser will ask for: --host 192.168.1.5");
  return host;
}

/// As it stands in an address: browsers send names in small letters, and IPv6 in brackets.
std::string in_url(std::string host) {
  std::transform(host.begin(), host.end(), host.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return host.find(':') == std::string::npos ? host : "[" + host + "]";
}

/// By a provider, because the library would compress whole text bodies for seconds.
void send(httplib::Response& response, WebAnswer answer) {
  response.status = answer.status;
  if (!answer.saved_as.empty())
    response.set_header("Content-Disposition", "attachment; filename=\"" + answer.saved_as + "\"");
  const auto kept = std::make_shared<std::string>(std::move(answer.body));
  response.set_content_provider(kept->size(), answer.type,
                                [kept](size_t offset, size_t length, httplib::DataSink& sink) {
                                  return sink.write(kept->data() + offset, length);
                                });
}

void refuse(httplib::Response& response, int status, const std::string& why) {
  response.status = status;
  response.set_content(why, "text/plain; charset=utf-8");
}

}  // namespace

WebAnswer answer_json(const json& document) {
  WebAnswer answer;
  answer.body = document.dump(-1, ' ', false, json::error_handler_t::replace);
  return answer;
}

WebAnswer refusal(int status, const std::string& why) {
  return {status, why, "text/plain; charset=utf-8", ""};
}

struct LocalServer::Impl {
  Impl(ServedThing served, const ServerOptions& told, size_t largest_request)
      : options(told), name(in_url(one_address(told.host))), lock(served), token(make_token()) {
    server.set_payload_max_length(largest_request);
    server.set_default_headers({{"Cache-Control", "no-store"},
                                {"Referrer-Policy", "no-referrer"},
                                {"X-Content-Type-Options", "nosniff"},
                                // what a page cannot say of itself; the rest it does
                                {"Content-Security-Policy", "frame-ancestors 'none'"},
                                {"Cross-Origin-Resource-Policy", "same-origin"}});
    guard();
    // Addresses that others use are refused rather than shared.
    server.set_socket_options([](socket_t) {});
  }

  void guard() {
    using httplib::Request;
    using httplib::Response;
    server.set_pre_routing_handler([this](const Request& request, Response& response) {
      const std::string local = fmt::format("localhost:{}", port);
      const std::string told = request.get_header_value("Host");
      if (told != host && told != local) {
        refuse(response, 403, "wrong host");
      } else if (request.path.rfind("/" + token + "/", 0) != 0) {
        refuse(response, 404, "not found");
      } else if (request.method == "POST" &&
                 request.get_header_value("Origin") != "http://" + told) {
        refuse(response, 403, "wrong origin");
      } else {
        return httplib::Server::HandlerResponse::Unhandled;
      }
      // Its body has not been read, and would be taken for the next request of this connection.
      response.set_header("Connection", "close");
      return httplib::Server::HandlerResponse::Handled;
    });
    server.set_exception_handler([](const Request&, Response& response, std::exception_ptr error) {
      try {
        std::rethrow_exception(error);
      } catch (const InputError& known) {
        refuse(response, 400, known.what());
      } catch (const json::exception&) {
        refuse(response, 400, "the request cannot be understood");
      } catch (const std::exception& known) {
        refuse(response, 500, known.what());
      } catch (...) {
        refuse(response, 500, "internal error");
      }
    });
  }

  httplib::Server::Handler wrapped(Handler handler) {
    return [handler = std::move(handler)](const httplib::Request& request,
                                          httplib::Response& response) {
      send(response, handler({request.body, [&](const std::string& parameter) {
                                return request.get_param_value(parameter);
                              }}));
    };
  }

  std::string path(const std::string& page) const { return "/" + token + "/" + page; }

  ServerOptions options;
  std::string name;  ///< first: a host that cannot be is refused before anything is opened
  ServerLock lock;
  std::string token, host;
  int port = -1;
  std::atomic<bool> ended{false};
  httplib::Server server;
};

LocalServer::LocalServer(ServedThing served, const ServerOptions& options, size_t largest_request)
    : impl_(std::make_unique<Impl>(std::move(served), options, largest_request)) {}
LocalServer::~LocalServer() = default;

void LocalServer::get(const std::string& name, Handler handler) {
  impl_->server.Get(impl_->path(name), impl_->wrapped(std::move(handler)));
}
void LocalServer::post(const std::string& name, Handler handler) {
  impl_->server.Post(impl_->path(name), impl_->wrapped(std::move(handler)));
}

void LocalServer::open() {
  Impl& own = *impl_;
  const ServerOptions& options = own.options;
  own.port = options.port > 0
                 ? (own.server.bind_to_port(options.host, options.port) ? options.port : -1)
                 : own.server.bind_to_any_port(options.host);
  if (own.port < 0)
    throw InputError({options.host}, fmt::format("port {} cannot be used", options.port),
                     "choose another with --port, or leave it out");
  own.host = fmt::format("{}:{}", own.name, own.port);
  own.lock.tell(address());
}

std::string LocalServer::address() const {
  return fmt::format("http://{}/{}/", impl_->host, impl_->token);
}

void LocalServer::run(const std::function<void()>& ended) {
  Impl& own = *impl_;
  std::thread watch([&] {
    while (!interrupted() && !own.ended) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    ended();
    own.server.stop();
  });
  own.server.listen_after_bind();
  own.ended = true;
  watch.join();
}

}  // namespace hookeye
