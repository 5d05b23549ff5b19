# Sources of tests as one: awk -f together.awk pass=1 SOURCES... pass=2 SOURCES... writes their #include lines, then the
# rest of each in a namespace of its own, as sources of one program may use one name for different things. Messages of
# compiler and tests name the sources and their lines.
pass == 1 { if (/^#include/) print; next }
FNR == 1 {
  if (stem != "") print "}  // namespace " stem
  stem = FILENAME
  gsub(/.*\/|\.cpp$/, "", stem)
  print "namespace " stem " {\n#line 1 \"" FILENAME "\""
}
{ print /^#include/ ? "" : $0 }
END { print "}  // namespace " stem }
