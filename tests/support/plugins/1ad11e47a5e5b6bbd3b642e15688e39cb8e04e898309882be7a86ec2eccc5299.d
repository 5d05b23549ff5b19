.logisticmap.tch.so.1vZwGT/logisticmap.tch.so: \
 .logisticmap.tch.so.1vZwGT/logisticmap.cpp \
 /work/main/src/contract/include/tchat/problem.hpp \
 /work/main/src/contract/include/tchat/dual.hpp \
 /work/main/src/contract/include/tchat/lanes.hpp \
 /work/main/src/contract/include/tchat/problem.h \
 /work/main/src/contract/include/tchat/sliding.hpp
