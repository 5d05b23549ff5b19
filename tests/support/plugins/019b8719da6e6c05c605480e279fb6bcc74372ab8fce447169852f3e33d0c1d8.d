.tentmap.tch.so.hDYVo2/tentmap.tch.so: .tentmap.tch.so.hDYVo2/tentmap.cpp \
 /work/main/src/contract/include/tchat/problem.hpp \
 /work/main/src/contract/include/tchat/dual.hpp \
 /work/main/src/contract/include/tchat/lanes.hpp \
 /work/main/src/contract/include/tchat/problem.h \
 /work/main/src/contract/include/tchat/sliding.hpp
