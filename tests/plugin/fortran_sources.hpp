/// Fortran sources for tests: a pendulum-like field with every derivative by hand, and ways to spoil it.
#pragma once

#include <stdexcept>
#include <string>

#include "plugin/fortran_problem.hpp"

/// Two states, PAR(1..3) = a, b, r:
///     f_1 = (x2, -a sin(x1) - b x2^2),  h_1 = x1 - a,  h_2 = x1 x2,  g_1 = (x1, -r x2)
/// GCSTPNT sets a = 2, b = 0.5, r = 0.8, the duration 1.5 of segment 1 and a state.
inline std::string fortran_source() {
  return R"(      SUBROUTINE GCFUNC(GCNDIM,X,PAR,GCIDIFF,FI,
     +     DFIDX,DFIDP,DFIDXDX,DFIDXDP,SEGNO)
      IMPLICIT DOUBLE PRECISION (A-H,O-Z)
      INTEGER GCNDIM,GCIDIFF,SEGNO
      DIMENSION X(GCNDIM),PAR(*),FI(GCNDIM)
      DIMENSION DFIDX(GCNDIM,GCNDIM),DFIDP(GCNDIM,*)
      DIMENSION DFIDXDX(GCNDIM,GCNDIM,GCNDIM)
      DIMENSION DFIDXDP(GCNDIM,GCNDIM,*)
      IF (SEGNO.NE.1) STOP
      FI(1)=X(2)
      FI(2)=-PAR(1)*SIN(X(1))-PAR(2)*X(2)**2
      IF (GCIDIFF.GE.1) THEN
        DFIDX(1,2)=1.0D0
        DFIDX(2,1)=-PAR(1)*COS(X(1))
        DFIDX(2,2)=-2.0D0*PAR(2)*X(2)
        DFIDP(2,1)=-SIN(X(1))
        DFIDP(2,2)=-X(2)**2
      END IF
      IF (GCIDIFF.GE.2) THEN
        DFIDXDX(2,1,1)=PAR(1)*SIN(X(1))
        DFIDXDX(2,2,2)=-2.0D0*PAR(2)
        DFIDXDP(2,1,1)=-COS(X(1))
        DFIDXDP(2,2,2)=-2.0D0*X(2)
      END IF
      END
      SUBROUTINE GCBOUND(GCNDIM,X,PAR,GCIDIFF,
     +     H,DHDX,DHDP,DHDXX,DHDXDP,SEGNO)
      IMPLICIT DOUBLE PRECISION (A-H,O-Z)
      INTEGER GCNDIM,GCIDIFF,SEGNO
      DIMENSION X(GCNDIM),PAR(*),DHDX(GCNDIM),DHDP(*)
      DIMENSION DHDXX(GCNDIM,GCNDIM),DHDXDP(GCNDIM,*)
      IF (SEGNO.EQ.1) THEN
        H=X(1)-PAR(1)
        IF (GCIDIFF.GE.1) DHDX(1)=1.0D0
        IF (GCIDIFF.GE.1) DHDP(1)=-1.0D0
      ELSE IF (SEGNO.EQ.2) THEN
        H=X(1)*X(2)
        IF (GCIDIFF.GE.1) DHDX(1)=X(2)
        IF (GCIDIFF.GE.1) DHDX(2)=X(1)
        IF (GCIDIFF.GE.2) DHDXX(1,2)=1.0D0
        IF (GCIDIFF.GE.2) DHDXX(2,1)=1.0D0
      END IF
      END
      SUBROUTINE JUMPMAP(GCNDIM,U1,PAR,UJUMP,
     +     COEFFRES,UJUMPDX,UJUMPDP,SEGNO)
      IMPLICIT DOUBLE PRECISION (A-H,O-Z)
      INTEGER GCNDIM,SEGNO
      DIMENSION U1(GCNDIM),UJUMP(GCNDIM),PAR(*)
      DIMENSION UJUMPDX(GCNDIM,GCNDIM),UJUMPDP(GCNDIM,*)
      COEFFRES=PAR(3)
      UJUMP(1)=U1(1)
      UJUMP(2)=-PAR(3)*U1(2)
      UJUMPDX(1,1)=1.0D0
      UJUMPDX(2,2)=-PAR(3)
      END
      SUBROUTINE GCSTPNT(GCNDIM,X,PAR,T,SEGNO)
      IMPLICIT DOUBLE PRECISION (A-H,O-Z)
      INTEGER GCNDIM,SEGNO
      DIMENSION X(GCNDIM),PAR(*)
      PAR(1)=2.0D0
      PAR(2)=0.5D0
      PAR(3)=0.8D0
      PAR(61)=1.5D0
      X(1)=0.25D0
      X(2)=0.75D0
      END
)";
}

/// The source with the one place where `old` stands changed.
inline std::string spoilt(const std::string& old, const std::string& text) {
  std::string source = fortran_source();
  const std::size_t at = source.find(old);
  if (at == std::string::npos) throw std::logic_error("the source holds no " + old);
  return source.replace(at, old.size(), text);
}

inline tchat::ProblemSizes fortran_sizes(int order, int dimension = 2) {
  tchat::ProblemSizes sizes;
  sizes.dimension = dimension;
  sizes.parameters = 1;
  sizes.segments = 2;
  sizes.derivative_order = order;
  sizes.fields = {1};
  sizes.events = {1, 2};
  sizes.jumps = {1};
  return sizes;
}
