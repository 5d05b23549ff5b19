# Of the lines that tests/support/timed writes (user seconds, system seconds, command; tabs between): the sums by kind, or
# with -v tests=1 each test.
function kind(command) {
  if (command ~ / -c .*-o .*|-o .* -c /) return "compiling"
  if (command ~ /^[^ ]*\/(c\+\+|g\+\+|cc|gcc|clang\+\+|ar|ranlib|cmake)/) return "linking"
  if (command ~ /sanitized_|^sanitized: /) return "sanitized"
  if (command ~ /support\/shard|structure\/|files\//) return "unit"
  if (command ~ /docs\/|update-pages/) return "pages"
  if (command ~ /campaign\//) return "campaign"
  if (command ~ /test_published|test_tori/) return "published"
  if (command ~ /\/python\//) return "python"
  return "end to end"
}
function name(command,  words, count, k, text) {
  count = split(command, words, " ")
  for (k = 1; k <= count; ++k) {
    sub(/.*\//, "", words[k])
    if (words[k] !~ /^(python3?|-B|bash|zsh|tchat|shard)$/) text = text " " words[k]
  }
  return substr(text, 2, 100)
}
BEGIN { FS = "\t" }
NF == 3 && $1 ~ /^[0-9.]+$/ && $2 ~ /^[0-9.]+$/ {
  if (!tests)
    sum[kind($3)] += $1 + $2
  else if (kind($3) !~ /ing$/)
    printf "%7.1f %s\n", $1 + $2, name($3)
}
END {
  for (one in sum) printf "%7.1f %s\n", sum[one], one
}
