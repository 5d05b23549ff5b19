! For Fortran problems written for TC-HAT, which switch their own messages by these names: INCLUDE 'gccont.h' after the
! IMPLICIT line, in fixed or free form. DEBUG is false until the including subroutine sets it.
      LOGICAL DEBUG
      INTEGER DBGLEV, DBGL2
      DATA DEBUG /.FALSE./, DBGLEV /0/, DBGL2 /1/
