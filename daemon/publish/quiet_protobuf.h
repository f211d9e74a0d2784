// What protobuf says by itself.
#pragma once

namespace rayloc {

// Protobuf writes a line to standard error for each message whose text is not UTF-8, as fast as a
// peer sends them and past every limit of a log. Whoever reads a message here counts or names what
// is none, so those lines are left out. Before any thread is started.
void quiet_protobuf();

}  // namespace rayloc
