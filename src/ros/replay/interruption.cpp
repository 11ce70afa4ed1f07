#include "ros/replay/interruption.h"

#include <csignal>

namespace tissue_contact {
namespace {

volatile std::sig_atomic_t g_signal = 0;  // a signal handler reaches nothing but what is global

/// The first one; the second, of either kind, ends the process.
extern "C" void noteSignal(int signal) {
  g_signal = signal;
  for (const int one : {SIGINT, SIGTERM}) std::signal(one, SIG_DFL);
}

void setHandler(void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

}  // namespace

SignalWatch::SignalWatch() {
  g_signal = 0;
  setHandler(noteSignal, SA_RESTART);
}

SignalWatch::~SignalWatch() { setHandler(SIG_DFL, 0); }

int SignalWatch::signal() { return g_signal; }

}  // namespace tissue_contact
