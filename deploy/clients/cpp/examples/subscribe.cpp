// Prints the position of every target, and problems of the connection.
//   subscribe [ENDPOINT [SNAPSHOT [SERVER_KEY_FILE SECRET_KEY_FILE]]]
#include <rayloc/client.h>

#include <iostream>

int main(int argc, char** argv) {
  rayloc::client::Options options{.topics = {"v1/location/"}};
  options.endpoint = argc > 1 ? argv[1] : options.endpoint;
  options.snapshot = argc > 2 ? argv[2] : "";
  if (argc > 4) {
    options.curve = rayloc::client::Curve::read(argv[3], argv[4]);
  }
  rayloc::client::Subscriber messages(options);
  while (true) {
    const auto message = messages.receive(std::chrono::seconds(1));
    if (message && message->envelope.location().has_position()) {
      const auto& position = message->envelope.location().position();
      std::cout << message->target() << " " << position.x() << " " << position.y();
    } else if (messages.stale()) {
      std::cout << "stale";
    } else {
      continue;
    }
    std::cout << " lost=" << messages.lost() << " restarts=" << messages.restarts() << std::endl;
  }
}
