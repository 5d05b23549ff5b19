.Moebiusmap.tch.so.3iNNDp/Moebiusmap.tch.so: \
 .Moebiusmap.tch.so.3iNNDp/Moebiusmap.cpp \
 /work/main/src/contract/include/tchat/problem.hpp \
 /work/main/src/contract/include/tchat/dual.hpp \
 /work/main/src/contract/include/tchat/lanes.hpp \
 /work/main/src/contract/include/tchat/problem.h \
 /work/main/src/contract/include/tchat/sliding.hpp
