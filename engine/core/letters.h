#pragma once

#include <string>
#include <string_view>

// Small and capital letters of ASCII, in every locale; what is no such letter stays as it is.
namespace rmlcell {

char LowerCase(char c);
char UpperCase(char c);
std::string LowerCase(std::string_view text);
std::string UpperCase(std::string_view text);

// Without the blanks at both ends.
std::string_view Trimmed(std::string_view text, std::string_view blanks = " \t\r");

bool EqualIgnoringCase(std::string_view a, std::string_view b);

}  // namespace rmlcell
