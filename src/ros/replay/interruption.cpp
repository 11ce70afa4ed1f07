#include "ros/replay/interruption.h"

#include <csignal>

namespace tissue_contact {
namespace {

volatile std::sig_atomic_t g_signal = 0;  // a signal handler reaches nothing but what is global

extern "C" void noteSignal(int signal) { g_signal = signal; }

void setHandler(void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

}  // namespace

SignalWatch::SignalWatch() {
  g_signal = 0;
  setHandler(noteSignal, static_cast<int>(SA_RESETHAND | SA_RESTART));
}

SignalWatch::~SignalWatch() { setHandler(SIG_DFL, 0); }

int SignalWatch::signal() { return g_signal; }

}  // namespace tissue_contact
