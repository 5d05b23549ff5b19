.walker.tch.so.2p98Lh/walker.tch.so: .walker.tch.so.2p98Lh/walker.cpp \
 /work/main/src/contract/include/tchat/problem.hpp \
 /work/main/src/contract/include/tchat/dual.hpp \
 /work/main/src/contract/include/tchat/lanes.hpp \
 /work/main/src/contract/include/tchat/problem.h \
 /work/main/src/contract/include/tchat/sliding.hpp
