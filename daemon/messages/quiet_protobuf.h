// Suppresses protobuf's own log output.
#pragma once

namespace rayloc {

// Protobuf writes a line to standard error for each message whose text is not UTF-8, at the rate of
// the sender and beyond every limit of a log. Every reader here counts or names invalid messages,
// so those lines are suppressed. To be called before any thread is started.
void quiet_protobuf();

}  // namespace rayloc
