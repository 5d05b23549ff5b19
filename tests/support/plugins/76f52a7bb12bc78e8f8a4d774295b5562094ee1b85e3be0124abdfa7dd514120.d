.oscillators1to2.tch.so.3yClfF/oscillators1to2.tch.so: \
 .oscillators1to2.tch.so.3yClfF/oscillators1to2.cpp \
 /work/main/src/contract/include/tchat/problem.hpp \
 /work/main/src/contract/include/tchat/dual.hpp \
 /work/main/src/contract/include/tchat/lanes.hpp \
 /work/main/src/contract/include/tchat/problem.h \
 /work/main/src/contract/include/tchat/sliding.hpp
