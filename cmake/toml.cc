// The one source that makes what toml++ has to make (Toml.cmake).
#include <toml++/toml.h>
