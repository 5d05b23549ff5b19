.slowfocus.tch.so.ou3lCV/slowfocus.tch.so: \
 .slowfocus.tch.so.ou3lCV/slowfocus.cpp \
 /work/main/src/contract/include/tchat/problem.hpp \
 /work/main/src/contract/include/tchat/dual.hpp \
 /work/main/src/contract/include/tchat/lanes.hpp \
 /work/main/src/contract/include/tchat/problem.h \
 /work/main/src/contract/include/tchat/sliding.hpp
