/// Texts in pictures: names of the problem set as mathematics (alpha, x1, MAX x1), everything else as it is.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tchat {

/// A text and whether it is gnuplot's markup (subscripts) or to be shown as it is.
struct LabelText {
  std::string text;
  bool markup = false;

  bool empty() const { return text.empty(); }
};

/// A text of the user: control characters become blanks.
LabelText plain_text(std::string_view text);

/// The name of a parameter, state or column as mathematics: Greek names become letters and numbers at the end of a
/// name subscripts (omega -> Greek omega, x1 -> x with subscript 1, "MAX x1" -> "max x" with subscript 1, L2-NORM ->
/// L with subscript 2, norm). What is no such name stays as it is.
LabelText mathematical_name(std::string_view name);

/// The letter xi with all n as its subscript: "2,4"; three and more in a row as "1...5".
LabelText xi_name(const std::vector<int>& n);

/// The number with a proper minus sign.
LabelText number_text(double value);

/// The two one after the other.
LabelText joined(const LabelText& first, const LabelText& second);

/// Width of the text in units of the font's size, from the widths of characters of a common sans-serif font.
double text_width(const LabelText& text);

/// Height of a line likewise: a subscript hangs below it.
double text_height(const LabelText& text);

/// The text as a string of gnuplot that says just that: every text that enters a script goes through here. In single
/// quotes, where nothing is special but the quote itself; a text that has one, which gnuplot does not read at its ends
/// or doubled, in double quotes with octal codes for what is special there. Throws UserError for control characters: a
/// line's end would begin a command.
std::string gnuplot_quoted(std::string_view text);

/// Throws UserError, beginning with `what`, when a name has a control character in it.
void refuse_control_characters(std::string_view name, std::string_view what);

}  // namespace tchat
