#pragma once

#include <string>
#include <string_view>

namespace rmlcell::server {

// What a host must hold, whatever bytes come to it; both return what is wrong, empty when nothing
// is.

// The file of its journal, and what is made of it. The first byte chooses:
//   'r'  the bytes as they are: what is read of them is read again from the same bytes
//   'd'  entries made of the bytes, one byte of their records changed or the rest cut off: all
//        before that is there and nothing else (LIVE-3.24)
// What was recovered is the newest mark and all that was told before it, and a machine made of that
// stands (LIVE-2.05, 3.30).
std::string TryJournal(std::string_view bytes);

// Messages of its server, HostResponse each behind two bytes of length, to a machine of either
// family by the first byte; a millisecond and more goes by between them. Orders are answered by
// their numbers, what is told counts up, a machine that stands stays where it is.
std::string TryHostMessages(std::string_view bytes);

}  // namespace rmlcell::server
