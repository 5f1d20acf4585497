// Man pages: troff with the man macros.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "app/manual/verb.h"

namespace hookeye {
namespace {

/// Text as troff shows it unchanged.
std::string plain(const std::string& text) {
  std::string out;
  bool first = true;
  for (const char c : text) {
    if (first && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
    first = c == '\n';
  }
  return out;
}

std::string bold(const std::string& text) { return "\\fB" + plain(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + plain(text) + "\\fR"; }

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string head(const std::string& name, const std::string& title, const std::string& version) {
  return fmt::format(".TH {} 1 \"\" \"hookeye {}\" \"Hookeye\"\n.SH NAME\n{} \\- {}\n",
                     upper(plain(name)), version, plain(name), plain(title));
}

std::string joined(const std::vector<std::string>& all, const std::string& between) {
  std::string out;
  for (const std::string& one : all) out += (out.empty() ? "" : between) + one;
  return out;
}

/// What is to be typed: "-o, --out TEXT".
std::string heading(const Word& word) {
  std::vector<std::string> names;
  for (const std::string& name : word.names)
    names.push_back(name.starts_with('-') ? bold(name) : italic(name));
  std::string out = joined(names, ", ");
  if (word.names.front().starts_with('-') && !word.value.empty()) out += " " + italic(word.value);
  return out;
}

std::string entry(const Word& word) {
  std::string out = ".TP\n" + heading(word) + "\n" + plain(word.description);
  const bool told = std::all_of(word.choices.begin(), word.choices.end(), [&](const auto& choice) {
    return word.description.find(choice) != std::string::npos;
  });
  if (!word.choices.empty() && !told) out += "\n(" + plain(joined(word.choices, ", ")) + ")";
  return out + "\n";
}

std::string entries(const std::string& title, const std::vector<Word>& words) {
  if (words.empty()) return {};
  std::string out = ".SH " + title + "\n";
  for (const Word& word : words) out += entry(word);
  return out;
}

std::string synopsis(const Verb& verb) {
  std::string out = ".SH SYNOPSIS\n.B hookeye " + plain(verb.name) + "\n";
  for (const Word& word : verb.options) {
    if (!word.required) continue;
    out += bold(word.names.front()) + " " + italic(word.value) + "\n";
  }
  for (const Word& word : verb.places) {
    const std::string name = italic(word.names.front()) + (word.many ? " ..." : "");
    out += word.required ? name + "\n" : "[" + name + "]\n";
  }
  return out + "[\\fIoptions\\fR]\n";
}

/// Lines as they are: tables.
std::string as_it_stands(const std::string& title, const std::string& text) {
  if (text.find_first_not_of(" \n") == std::string::npos) return {};
  return ".SH " + title + "\n.nf\n" + plain(text.substr(text.find_first_not_of('\n'))) +
         (text.ends_with('\n') ? "" : "\n") + ".fi\n";
}

constexpr const char* kExitStatus = R"(.SH EXIT STATUS
.TP
.B 0
done
.TP
.B 1
internal error
.TP
.B 2
bad input: file, line, what is wrong and what is right stand on standard error
.TP
.B 3
the numbers failed
.TP
.B 130
stopped by Ctrl\-C; all that is finished is kept
)";

constexpr const char* kEnvironment = R"(.SH ENVIRONMENT
.TP
.B HOOKEYE_LIBEXEC
folder of the helper programs (default: libexec/hookeye beside the program)
.TP
.B HOOKEYE_ISA
sse2, avx, avx2 or avx512: use no wider vectors
.TP
.B TMPDIR
folder for temporary files
)";

std::string page_of_program(const std::vector<Verb>& verbs, const std::string& version) {
  std::string out =
      head("hookeye", "elastic models of soft objects from photos under known loads", version);
  out += ".SH SYNOPSIS\n.B hookeye\n\\fIcommand\\fR [\\fIarguments\\fR] [\\fIoptions\\fR]\n";
  out += ".SH DESCRIPTION\n" + plain(verbs.front().description) + "\n.SH COMMANDS\n";
  for (size_t i = 1; i < verbs.size(); ++i)
    out += ".TP\n" + bold(verbs[i].name) + "\n" + plain(verbs[i].description) + ": " +
           bold("hookeye-" + verbs[i].name) + "(1)\n";
  out += entries("OPTIONS", verbs.front().options) + kExitStatus + kEnvironment;
  return out + ".SH SEE ALSO\nREADME.md and the guides beside it in the documentation's folder\n";
}

}  // namespace

std::vector<std::pair<std::string, std::string>> man_pages(const std::vector<Verb>& verbs,
                                                           const std::string& version) {
  std::vector<std::pair<std::string, std::string>> out;
  out.emplace_back("hookeye.1", page_of_program(verbs, version));
  for (size_t i = 1; i < verbs.size(); ++i) {
    const Verb& verb = verbs[i];
    const std::string name = "hookeye-" + verb.name;
    out.emplace_back(name + ".1",
                     head(name, verb.description, version) + synopsis(verb) +
                         entries("ARGUMENTS", verb.places) + entries("OPTIONS", verb.options) +
                         as_it_stands("NOTES", verb.footer) + ".SH SEE ALSO\n.BR hookeye (1)\n");
  }
  return out;
}

}  // namespace hookeye
