.oscillators2to1.tch.so.fEfOU4/oscillators2to1.tch.so: \
 .oscillators2to1.tch.so.fEfOU4/oscillators2to1.cpp \
 /work/main/src/contract/include/tchat/problem.hpp \
 /work/main/src/contract/include/tchat/dual.hpp \
 /work/main/src/contract/include/tchat/lanes.hpp \
 /work/main/src/contract/include/tchat/problem.h \
 /work/main/src/contract/include/tchat/sliding.hpp
