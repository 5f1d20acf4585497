#include "app/server/studio_server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/file.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <thread>

#include "app/interrupt.h"
#include "app/server/refit_job.h"
#include "core/input_error.h"
#include "core/text_file.h"
#include "runs/report/inside.h"
#include "runs/report/page.h"

// Last: it includes resolv.h, whose macro _res breaks Eigen's headers.
#include <httplib.h>

#include <nlohmann/json.hpp>

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

/// One studio a run: RUN/.studio is locked while it is open and holds its address, readable by its
/// owner alone. The kernel drops the lock with the process.
class StudioLock {
 public:
  explicit StudioLock(const fs::path& run) : file_(run / ".studio") {
    // Not through a link: the address would be written into what it leads to.
    handle_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (handle_ < 0) return;  // a run that cannot be written is shown all the same
    if (::flock(handle_, LOCK_EX | LOCK_NB) == 0) return;
    ::close(handle_);
    handle_ = -1;
    std::string where = "in another process";
    try {
      where = "at " + read_text(file_);
    } catch (const std::exception&) {
    }
    throw InputError({run.string()}, "a studio is open on this run already, " + where,
                     "open that address, or end that studio with Ctrl-C");
  }
  StudioLock(const StudioLock&) = delete;
  StudioLock& operator=(const StudioLock&) = delete;
  ~StudioLock() {
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

/// The studio answers under one name alone (guard()), so it must be told one.
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

class Studio {
 public:
  Studio(const fs::path& run, const StudioOptions& options)
      : name_(in_url(one_address(options.host))),
        lock_(run),
        view_(run),
        job_(run),
        token_(make_token()) {
    make_page(view_.document());  // fails here, not at the first request, when there is no page
    guard();
    route();
    // Addresses that others use are refused rather than shared.
    server_.set_socket_options([](socket_t) {});
    port_ = options.port > 0
                ? (server_.bind_to_port(options.host, options.port) ? options.port : -1)
                : server_.bind_to_any_port(options.host);
    if (port_ < 0)
      throw InputError({options.host}, fmt::format("port {} cannot be used", options.port),
                       "choose another with --port, or leave it out");
    host_ = fmt::format("{}:{}", name_, port_);
    lock_.tell(address());
  }

  std::string address() const { return fmt::format("http://{}/{}/", host_, token_); }

  void run() {
    std::thread watch([this] {
      while (!interrupted() && !ended_) std::this_thread::sleep_for(std::chrono::milliseconds(50));
      job_.stop();
      server_.stop();
    });
    server_.listen_after_bind();
    ended_ = true;
    watch.join();
  }

 private:
  using Request = httplib::Request;
  using Response = httplib::Response;

  static void refuse(Response& response, int status, const std::string& why) {
    response.status = status;
    response.set_content(why, "text/plain; charset=utf-8");
  }
  /// By a provider, because the library would compress whole text bodies for seconds.
  static void send(Response& response, std::string body, const char* type) {
    const auto kept = std::make_shared<std::string>(std::move(body));
    response.set_content_provider(kept->size(), type,
                                  [kept](size_t offset, size_t length, httplib::DataSink& sink) {
                                    return sink.write(kept->data() + offset, length);
                                  });
  }
  static void reply(Response& response, const json& document) {
    send(response, document.dump(-1, ' ', false, json::error_handler_t::replace),
         "application/json");
  }

  /// Only this machine's own name (so that no other site can be pointed at this port), only with
  /// the token, and changes only from this very page.
  void guard() {
    server_.set_payload_max_length(4096);
    server_.set_default_headers({{"Cache-Control", "no-store"},
                                 {"Referrer-Policy", "no-referrer"},
                                 {"X-Content-Type-Options", "nosniff"},
                                 // what a page cannot say of itself; the rest it does
                                 {"Content-Security-Policy", "frame-ancestors 'none'"},
                                 {"Cross-Origin-Resource-Policy", "same-origin"}});
    server_.set_pre_routing_handler([this](const Request& request, Response& response) {
      const std::string local = fmt::format("localhost:{}", port_);
      const std::string host = request.get_header_value("Host");
      if (host != host_ && host != local) {
        refuse(response, 403, "wrong host");
      } else if (request.path.rfind("/" + token_ + "/", 0) != 0) {
        refuse(response, 404, "not found");
      } else if (request.method == "POST" &&
                 request.get_header_value("Origin") != "http://" + host) {
        refuse(response, 403, "wrong origin");
      } else {
        return httplib::Server::HandlerResponse::Unhandled;
      }
      // Its body has not been read, and would be taken for the next request of this connection.
      response.set_header("Connection", "close");
      return httplib::Server::HandlerResponse::Handled;
    });
    server_.set_exception_handler([](const Request&, Response& response, std::exception_ptr error) {
      try {
        std::rethrow_exception(error);
      } catch (const std::exception& known) {
        refuse(response, 500, known.what());
      } catch (...) {
        refuse(response, 500, "internal error");
      }
    });
  }

  json document() {
    json out = view_.document();
    out["live"] = true;
    return out;
  }

  json job_state() {
    json out = job_.state();
    out["steps"] = view_.step_count();
    return out;
  }

  void file(const Request& request, Response& response) {
    std::error_code error;
    const fs::path wanted = fs::canonical(view_.folder() / request.get_param_value("name"), error);
    static const std::string kKinds[] = {".json", ".vtu", ".csv", ".yaml", ".exr", ".png"};
    const bool kind =
        std::find(std::begin(kKinds), std::end(kKinds), wanted.extension()) != std::end(kKinds);
    if (error || !inside(view_.folder(), wanted) || !kind || !fs::is_regular_file(wanted))
      return refuse(response, 404, "there is no such file in this run");
    std::string name = wanted.filename().string();
    std::replace_if(
        name.begin(), name.end(),
        [](unsigned char c) { return c < 32 || c == 127 || c == '"' || c == '\\'; }, '_');
    response.set_header("Content-Disposition", "attachment; filename=\"" + name + "\"");
    send(response, read_text(wanted), "application/octet-stream");
  }

  void add(const Request& request, Response& response) {
    const json wanted = json::parse(request.body, nullptr, false);
    if (!wanted.is_object() || !wanted.contains("effect") || !wanted["effect"].is_string())
      return refuse(response, 400, "tell the effect: {\"effect\": \"gravity\"}");
    const json take_back = wanted.value("take_back", json(false));
    if (!take_back.is_boolean())
      return refuse(response, 400, "take_back is true or false, not " + take_back.dump());
    const AddRequest what{wanted["effect"], take_back};
    try {
      check_effect(what.effect);
    } catch (const InputError& error) {
      return refuse(response, 400, error.what());
    }
    // A refit reads the newest step and writes beside it: no link may lead it elsewhere.
    if (const fs::path out = link_out_of(view_.folder()); !out.empty())
      return refuse(response, 409,
                    fmt::format("{} is a link out of this run: nothing is written here",
                                out.lexically_relative(view_.folder()).string()));
    try {
      check_stands(open_run(view_.folder(), false), what);
    } catch (const InputError& error) {
      return refuse(response, 409, error.what());
    }
    if (!job_.start(what)) return refuse(response, 409, "a refit is running already");
    reply(response, job_state());
  }

  void route() {
    const std::string root = "/" + token_ + "/";
    server_.Get(root, [this](const Request&, Response& response) {
      send(response, make_page(document()), "text/html; charset=utf-8");
    });
    server_.Get(root + "document",
                [this](const Request&, Response& response) { reply(response, document()); });
    server_.Get(root + "job",
                [this](const Request&, Response& response) { reply(response, job_state()); });
    server_.Get(root + "part", [this](const Request& request, Response& response) {
      auto blob = view_.blob(request.get_param_value("name"));
      if (!blob) return refuse(response, 404, "there is no such part of this run");
      send(response, std::move(blob->bytes), blob->type.c_str());
    });
    server_.Get(root + "file",
                [this](const Request& request, Response& response) { file(request, response); });
    server_.Post(root + "add",
                 [this](const Request& request, Response& response) { add(request, response); });
    server_.Post(root + "stop", [this](const Request&, Response& response) {
      job_.stop();
      reply(response, job_state());
    });
  }

  std::string name_;  ///< first: a host that cannot be is refused before anything is opened
  StudioLock lock_;
  RunView view_;
  RefitJob job_;
  std::string token_, host_;
  int port_ = -1;
  std::atomic<bool> ended_{false};
  httplib::Server server_;
};

}  // namespace

void serve_studio(const fs::path& run, const StudioOptions& options,
                  const std::function<void(const std::string& address)>& ready) {
  Studio studio(run, options);
  ready(studio.address());
  studio.run();
}

}  // namespace hookeye
