// Ctrl-C and SIGTERM, as something that a loop can ask.
#pragma once

namespace stridor {

/// Routes SIGINT and SIGTERM to `stop_requested`; a second signal ends the program at once.
void install_stop_signals();

/// True once the user has asked the program to stop. Cheap; safe in any loop.
bool stop_requested();

/// As if the signal had come (tests, time limits); `false` takes the request back.
void request_stop(bool value = true);

}  // namespace stridor
