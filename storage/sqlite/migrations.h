#pragma once

#include <span>
#include <string>
#include <string_view>

#include "storage/records.h"
#include "storage/sqlite/database.h"

namespace rmlcell::storage::sqlite {

// One step of the schema. Steps are numbered from 1 without a gap, only ever added at the end, and
// never changed once released: a store says by its number which of them it has.
struct Migration {
  int number;
  std::string_view what;
  std::string_view sql;
};

std::span<const Migration> Migrations();

// Marks a file as ours, in the place that SQLite has for it ("RMLC").
inline constexpr int kApplicationId = 0x524D4C43;

// The number of the store, 0 for an empty file. Changes nothing. Errors: CellStoreNewer when it is
// above the newest of `migrations`; CellStoreCorrupt when the file is no database or another
// program's.
Result<int> StoreNumber(Database& database, std::span<const Migration> migrations);

// Brings the store to the newest of `migrations`, each step in a transaction of its own, so that a
// kill leaves a store of some number and the next start goes on. A store that has data is first
// copied whole to `path` + ".version-" + its number: there is no way back but this copy. Errors as
// StoreNumber().
Status Migrate(Database& database, std::span<const Migration> migrations, const std::string& path,
               WallTime now);

}  // namespace rmlcell::storage::sqlite
