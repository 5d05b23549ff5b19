.integrateandfire.tch.so.Oll8Yz/integrateandfire.tch.so: \
 .integrateandfire.tch.so.Oll8Yz/integrateandfire.cpp \
 /work/main/src/contract/include/tchat/problem.hpp \
 /work/main/src/contract/include/tchat/dual.hpp \
 /work/main/src/contract/include/tchat/lanes.hpp \
 /work/main/src/contract/include/tchat/problem.h \
 /work/main/src/contract/include/tchat/sliding.hpp
