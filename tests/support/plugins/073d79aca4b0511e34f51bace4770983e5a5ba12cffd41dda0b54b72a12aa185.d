.slowmode.tch.so.ILTWa5/slowmode.tch.so: \
 .slowmode.tch.so.ILTWa5/slowmode.cpp \
 /work/main/src/contract/include/tchat/problem.hpp \
 /work/main/src/contract/include/tchat/dual.hpp \
 /work/main/src/contract/include/tchat/lanes.hpp \
 /work/main/src/contract/include/tchat/problem.h \
 /work/main/src/contract/include/tchat/sliding.hpp
