#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage {
namespace {

INSTANTIATE_TEST_SUITE_P(Sqlite, StoreConformance,
                         testing::Values(StoreKind{"Sqlite",
                                                   [] { return std::make_unique<SqliteBed>(); }}),
                         NameOfKind);

}  // namespace
}  // namespace rmlcell::storage
