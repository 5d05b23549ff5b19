# Sources of tests as one: awk -f together.awk pass=1 SOURCES... pass=2 SOURCES... writes the #include lines that they
# begin with, then the rest of each in a namespace of its own, as sources of one program may use one name for different
# things. Messages of compiler and tests name the sources and their lines.
FNR == 1 { at_head = 1 }
/[^ \t]/ && !/^(#include|\/\/)/ { at_head = 0 }  # below it #include lines are those of plugins, in strings
pass == 1 { if (at_head && /^#include/) print; next }
FNR == 1 {
  if (stem != "") print "}  // namespace " stem
  stem = FILENAME
  gsub(/.*\/|\.cpp$/, "", stem)
  print "namespace " stem " {\n#line 1 \"" FILENAME "\""
}
{ print at_head && /^#include/ ? "" : $0 }
END { print "}  // namespace " stem }
