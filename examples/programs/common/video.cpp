// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/video.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <fstream>
#include <string>

#include "common/capture.hpp"
#include "common/failure.hpp"

namespace replay {
namespace {

namespace fs = std::filesystem;

constexpr unsigned longest_answer_s = 60;

// The messages between the two processes.
enum class Request : char { open, grab, retrieve };

struct Opened {
  double rate_hz = 0;
  std::size_t refusal_length = 0;  ///< of the text that follows; 0: the file is open
};

struct FrameHead {
  int rows = 0;
  int cols = 0;
  int type = 0;  ///< as of a cv::Mat
};

bool send(int socket, const void* data, std::size_t size) {
  const char* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t sent = ::send(socket, bytes, size, MSG_NOSIGNAL);
    if (sent < 0 && errno != EINTR) {
      return false;
    }
    bytes += sent > 0 ? sent : 0;
    size -= sent > 0 ? static_cast<std::size_t>(sent) : 0;
  }
  return true;
}

/// False at the end of the other process.
bool receive(int socket, void* data, std::size_t size) {
  char* bytes = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t received = ::recv(socket, bytes, size, 0);
    if (received == 0 || (received < 0 && errno != EINTR)) {
      return false;
    }
    bytes += received > 0 ? received : 0;
    size -= received > 0 ? static_cast<std::size_t>(received) : 0;
  }
  return true;
}

template <class Message>
bool send(int socket, const Message& message) {
  return send(socket, &message, sizeof message);
}

template <class Message>
bool receive(int socket, Message& message) {
  return receive(socket, &message, sizeof message);
}

std::size_t bytes_of(const cv::Mat& frame) {
  return frame.total() * frame.elemSize();
}

// What the decoder's process does.

/// How many threads OpenCV asks FFmpeg for.
double threads() {
  return static_cast<double>(std::max(1L, ::sysconf(_SC_NPROCESSORS_ONLN)));
}

/// Limits how much more memory this process may take, as Linux counts it: so many frames, of 16
/// bits and three colours, stacks of threads, and tables. A stream may claim larger frames than its
/// file.
void limit_memory(double frames, double pixels) {
  std::ifstream statm("/proc/self/statm");
  double pages = 0;
  for (int field = 0; field < 6; ++field) {
    statm >> pages;  // the sixth is data and stacks
  }
  rlimit limit{};
  if (statm && ::getrlimit(RLIMIT_DATA, &limit) == 0) {
    const double bytes = pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) +
                         frames * 6 * pixels + threads() * 16e6 + 64e6;
    limit.rlim_cur = std::min(limit.rlim_max, static_cast<rlim_t>(bytes));
    ::setrlimit(RLIMIT_DATA, &limit);
  }
}

cv::VideoCapture open(const fs::path& file, int socket) {
  try {
    limit_memory(3, max_frame_pixels());  // of any size, to find out what the file holds
    cv::VideoCapture source = open_video(file);
    // One for each thread, 16 that later ones refer to, and two copies of the last.
    limit_memory(threads() + 18,
                 source.get(cv::CAP_PROP_FRAME_WIDTH) * source.get(cv::CAP_PROP_FRAME_HEIGHT));
    send(socket, Opened{source.get(cv::CAP_PROP_FPS), 0});
    return source;
  } catch (const Failure& failure) {
    const std::string line = failure.what();
    send(socket, Opened{0, line.size()});
    send(socket, line.data(), line.size());
    return {};
  }
}

void send_frame(cv::VideoCapture& source, int socket) {
  cv::Mat frame = retrieve(source);
  if (double(frame.rows) * frame.cols > max_frame_pixels()) {
    frame.release();  // larger than the file claims
  }
  if (!frame.isContinuous()) {
    frame = frame.clone();
  }
  send(socket, FrameHead{frame.rows, frame.cols, frame.type()});
  send(socket, frame.data, bytes_of(frame));
}

/// Answers requests until the other process closes the socket. An exception ends this process, and
/// must not run on in the code of the other.
void answer_requests(const fs::path& file, int socket) noexcept {
  cv::VideoCapture source;
  for (Request request{}; receive(socket, request); ::alarm(0)) {
    ::alarm(longest_answer_s);
    if (request == Request::open) {
      source.release();
      source = open(file, socket);
    } else if (request == Request::grab) {
      send(socket, char{grab(source)});
    } else {
      send_frame(source, socket);
    }
  }
}

/// What decoders print goes nowhere, a crash leaves no core file, and signals from the keyboard are
/// for the other process.
void keep_to_itself() {
  ::dup2(::open("/dev/null", O_WRONLY), STDERR_FILENO);
  const rlimit none{};
  ::setrlimit(RLIMIT_CORE, &none);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    std::signal(signal, SIG_IGN);
  }
  std::signal(SIGALRM, SIG_DFL);
  cv::setNumThreads(0);  // OpenCV's threads stay in the other process; FFmpeg begins its own
}

}  // namespace

/// The other end: asks the process for frames.
class Video::Decoder {
 public:
  explicit Decoder(const fs::path& file) : file_(file) {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) {
      fail(file, "no process for its decoder can be started");
    }
    process_ = ::fork();
    if (process_ == 0) {
      ::close(ends[0]);
      keep_to_itself();
      answer_requests(file, ends[1]);
      ::_exit(0);
    }
    ::close(ends[1]);
    socket_ = ends[0];
    if (process_ < 0) {
      ::close(socket_);
      fail(file, "no process for its decoder can be started");
    }
  }
  ~Decoder() {
    ::close(socket_);
    end();
  }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  /// The frame rate.
  double open() {
    Opened opened;
    expect(send(socket_, Request::open) && receive(socket_, opened) &&
           opened.refusal_length < 10000);
    if (opened.refusal_length > 0) {
      std::string refusal(opened.refusal_length, ' ');
      expect(receive(socket_, refusal.data(), refusal.size()));
      throw Failure(refusal);
    }
    return opened.rate_hz;
  }

  bool grab() {
    char has_frame = 0;
    expect(send(socket_, Request::grab) && receive(socket_, has_frame));
    return has_frame != 0;
  }

  cv::Mat retrieve() {
    FrameHead head;
    expect(send(socket_, Request::retrieve) && receive(socket_, head));
    expect(head.rows >= 0 && head.cols >= 0 &&
           double(head.rows) * head.cols <= max_frame_pixels() &&
           head.type == CV_MAT_TYPE(head.type) && CV_MAT_CN(head.type) <= 4);
    cv::Mat frame(head.rows, head.cols, head.type);
    expect(receive(socket_, frame.data, bytes_of(frame)));
    return frame;
  }

 private:
  /// Throws Failure unless the process has answered, with an answer that makes sense.
  void expect(bool has_answered) {
    if (has_answered) {
      return;
    }
    end();
    fail(file_, WIFSIGNALED(status_) && WTERMSIG(status_) == SIGALRM
                    ? "its decoder takes more than a minute"
                    : "its decoder crashed (the file is damaged or hostile)");
  }

  void end() {
    if (process_ > 0) {
      ::kill(process_, SIGKILL);  // of no effect where it has ended by itself
      ::waitpid(process_, &status_, 0);
      process_ = -1;
    }
  }

  fs::path file_;
  int socket_ = -1;
  pid_t process_ = -1;
  int status_ = 0;  ///< how the process ended
};

Video::Video(const fs::path& file) : decoder_(std::make_unique<Decoder>(file)) {
  rewind();
}

Video::~Video() = default;
Video::Video(Video&&) noexcept = default;
Video& Video::operator=(Video&&) noexcept = default;

void Video::rewind() {
  rate_hz_ = decoder_->open();
}

bool Video::grab() {
  return decoder_->grab();
}

cv::Mat Video::retrieve() {
  return decoder_->retrieve();
}

}  // namespace replay
