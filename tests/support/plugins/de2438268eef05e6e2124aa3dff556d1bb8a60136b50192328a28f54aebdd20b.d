.ballonthefloor.tch.so.uj5sZR/ballonthefloor.tch.so: \
 .ballonthefloor.tch.so.uj5sZR/ballonthefloor.cpp \
 /work/main/src/contract/include/tchat/problem.hpp \
 /work/main/src/contract/include/tchat/dual.hpp \
 /work/main/src/contract/include/tchat/lanes.hpp \
 /work/main/src/contract/include/tchat/problem.h \
 /work/main/src/contract/include/tchat/sliding.hpp
