.oscillators1to3.tch.so.fBZ5Is/oscillators1to3.tch.so: \
 .oscillators1to3.tch.so.fBZ5Is/oscillators1to3.cpp \
 /work/main/src/contract/include/tchat/problem.hpp \
 /work/main/src/contract/include/tchat/dual.hpp \
 /work/main/src/contract/include/tchat/lanes.hpp \
 /work/main/src/contract/include/tchat/problem.h \
 /work/main/src/contract/include/tchat/sliding.hpp
