#pragma once

#include <string>

// Statements that fail in the middle of a read or write, as they do where a page is damaged or
// memory is short: the disk alone fails at the end of a write only.
namespace rmlcell::storage::failing_statements {

// Only connections that are opened from now on.
void Register();

// What is swept beside an operation does not make it fail, and is asked for by itself.
enum class Of { kWriter, kReaders, kSweeping };
// The statement of this number from now on, counted from 0, and each with the same text: an
// operation that is run again meets it again. Those that begin or end a transaction never fail.
void Fail(Of of, int number);
// The text of what failed since; empty when nothing did.
std::string Heal();

}  // namespace rmlcell::storage::failing_statements
