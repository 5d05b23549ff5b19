// Bad constants files and overrides: each is refused with one message that names place, constant and cure.
#include <catch2/catch.hpp>
#include <filesystem>

#include "base/messages.hpp"
#include "settings/constants_file.hpp"
#include "settings/sample_files.hpp"
#include "settings/settings_check.hpp"

using namespace tchat;
using tchat::testing::appendix_b;
using tchat::testing::appendix_b_with;

namespace {

struct Malformed {
  std::string text;
  std::vector<std::string> expected;  // parts of the message
};

/// The message of the UserError that `action` throws.
template <class Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const UserError& error) {
    return error.what();
  }
  return "(accepted)";
}

std::string first_lines(int count) {
  std::string text = appendix_b();
  std::size_t end = 0;
  for (int i = 0; i < count; ++i) end = text.find('\n', end) + 1;
  return text.substr(0, end);
}

/// For a problem of few parameters.
void resolve(RunSettings& settings) {
  resolve_names(settings, ParameterLayout(), [](const std::string&, const std::string&) { return names_a_monitor; });
}

void read_for_problem(const std::string& text) {
  RunSettings settings = read_constants_text(text, "gc.bad");
  resolve(settings);
}

void check_all(const std::vector<Malformed>& files) {
  for (const Malformed& file : files) {
    const std::string message = message_of([&] { read_for_problem(file.text); });
    for (const std::string& part : file.expected) {
      CAPTURE(file.text, message, part);
      CHECK(message.find(part) != std::string::npos);
    }
  }
}

}  // namespace

TEST_CASE("Malformed positional files", "[constants]") {
  const std::vector<Malformed> files{
      {appendix_b_with(1, "0 180 1 1"),
       {"gc.bad:1: NDIM (", "found '0'", "from 1 to 100000", "for example: 5 180 1 1"}},
      {appendix_b_with(1, "5.0 180 1 1"), {"gc.bad:1: NDIM (", "found '5.0'", "an integer"}},
      {appendix_b_with(1, "100001 180 1 1"), {"gc.bad:1: NDIM (", "'100001'"}},
      {appendix_b_with(1, "99999999999 180 1 1"), {"gc.bad:1: NDIM (", "'99999999999'"}},
      {appendix_b_with(1, "5 2 1 1"), {"gc.bad:1: IPS (", "found '2'", "180 (", "150 ("}},
      {appendix_b_with(1, "5 180 -1 1"), {"gc.bad:1: IRS (", "found '-1'", "label number"}},
      {appendix_b_with(1, "5 180 AB1 1"), {"gc.bad:1: IRS (", "found 'AB1'", "BP, LP, HB, PD"}},
      {appendix_b_with(1, "5 180 PD 1"), {"gc.bad:1: IRS (", "found 'PD'"}},
      {appendix_b_with(1, "5 180 PD0 1"), {"gc.bad:1: IRS (", "found 'PD0'"}},
      {appendix_b_with(1, "5 180 1 NDIM, IPS"), {"gc.bad:1: ILP (", "found 'NDIM'"}},
      {appendix_b_with(1, "5,,1 1"), {"gc.bad:1: IPS (", "','", "null value"}},
      {appendix_b_with(1, "5 180, ,1"), {"gc.bad:1: IRS (", "null value"}},
      {appendix_b_with(2, ", 3 1 61 62"), {"gc.bad:2: NICP (", "null value"}},
      {appendix_b_with(1, "5 180 /"), {"gc.bad:1: IRS (", "'/'"}},
      {appendix_b_with(1, "5/180 1 1"), {"gc.bad:1: IPS (", "'/'"}},
      {appendix_b_with(2, "0 NICP"), {"gc.bad:2: NICP (", "found '0'"}},
      {appendix_b_with(2, "-3 1 61 62"), {"gc.bad:2: NICP (", "found '-3'"}},
      {appendix_b_with(2, "1000000000 1 61 62"), {"gc.bad:2: NICP (", "'1000000000'", "100000"}},
      {appendix_b_with(2, "3 1 0 62"), {"gc.bad:2: ICP(2) (", "found '0'"}},
      {appendix_b_with(2, "3 1 61 300"), {"gc.bad:2: ICP(3) (", "found '300'"}},
      {appendix_b_with(2, "3 1 61 63"), {"gc.bad:2: ICP(3) (", "found '63'", "61 to 62"}},
      {appendix_b_with(2, "3 1 61 61"), {"gc.bad:2: ICP(3) (", "'61' twice"}},
      {appendix_b_with(2, "2 61 62"), {"gc.bad:2: ICP (", "0 parameters that are not durations", "at least 1"}},
      {appendix_b_with(3, "0 2 3 2 1 0 0 0"), {"gc.bad:3: NTST (", "found '0'", "from 1 to 5000"}},
      {appendix_b_with(3, "50 8 3 2 1 0 0 0"), {"gc.bad:3: NCOL (", "found '8'", "from 2 to 7"}},
      {appendix_b_with(3, "50 4 -3 2 1 0 0 0"), {"gc.bad:3: IAD (", "found '-3'"}},
      {appendix_b_with(3, "50 4 3 5 1 0 0 0"), {"gc.bad:3: ISP (", "found '5'"}},
      {appendix_b_with(3, "50 4 3 2 7 0 0 0"), {"gc.bad:3: ISW (", "found '7'", "2 (two-parameter"}},
      {appendix_b_with(3, "50 4 3 2 2 0 0 0"), {"gc.bad:2: ICP (", "at least 2"}},
      {appendix_b_with(3, "50 4 3 2 1 x 0 0"), {"gc.bad:3: IPLT (", "found 'x'"}},
      {appendix_b_with(3, "50 4 3 2 1 3* 0 0"), {"gc.bad:3: IPLT (", "'3*'", "r*v"}},
      {appendix_b_with(3, "50 4 3 2 1 0*0 0"), {"gc.bad:3: IPLT (", "'0*0'"}},
      {appendix_b_with(3, "50 4 3 2 1 2*3*0"), {"gc.bad:3: IPLT (", "'2*3*0'"}},
      {appendix_b_with(3, "50 4 3 2 1 *"), {"gc.bad:3: IPLT (", "'*'"}},
      {appendix_b_with(4, "-1 0.0 1.0 0.0 100.0"), {"gc.bad:4: NMX (", "found '-1'"}},
      {appendix_b_with(4, "100 1.0 1.0 0.0 100.0"), {"gc.bad:4: RL1 (", "found '1'", "greater than RL0 = 1"}},
      {appendix_b_with(4, "100 0.0 1.0 5 -5"), {"gc.bad:4: A1 (", "found '-5'", "greater than A0 = 5"}},
      {appendix_b_with(4, "100 nan 1.0 0 1"), {"gc.bad:4: RL0 (", "found 'nan'", "finite number"}},
      {appendix_b_with(4, "100 0 inf 0 1"), {"gc.bad:4: RL1 (", "found 'inf'"}},
      {appendix_b_with(4, "100 0 1e999 0 1"), {"gc.bad:4: RL1 (", "found '1e999'"}},
      {appendix_b_with(4, "100 0x1 1 0 1"), {"gc.bad:4: RL0 (", "found '0x1'"}},
      {appendix_b_with(4, "100 1.0.0 1 0 1"), {"gc.bad:4: RL0 (", "found '1.0.0'"}},
      {appendix_b_with(4, "100 1.0f 1 0 1"), {"gc.bad:4: RL0 (", "found '1.0f'"}},
      {appendix_b_with(4, "100 +-1 1 0 1"), {"gc.bad:4: RL0 (", "found '+-1'"}},
      {appendix_b_with(4, "100 1e 1 0 1"), {"gc.bad:4: RL0 (", "found '1e'"}},
      {appendix_b_with(5, "1 0 -2 10 8 3 0"), {"gc.bad:5: IID (", "found '-2'"}},
      {appendix_b_with(5, "1 0 2 10 0 3 0"), {"gc.bad:5: ITNW (", "found '0'"}},
      {appendix_b_with(6, "0 1e-7 1e-7"), {"gc.bad:6: EPSL (", "found '0'", ">= 1e-13"}},
      {appendix_b_with(6, "1e-7 1e-14 1e-7"), {"gc.bad:6: EPSU (", "found '1e-14'", ">= 1e-13"}},
      {appendix_b_with(6, "1e-7 -1e-7 1e-7"), {"gc.bad:6: EPSU (", "found '-1e-7'", "for example: 1e-7 1e-7 1e-5"}},
      {appendix_b_with(6, "1e-7 1e-7"),
       {"gc.bad:8: DSMIN (", "found 'NTHL'", "EPSL, EPSU, EPSS on line 6 has been read on to line 7"}},
      {appendix_b_with(7, "0.0 0.0 0.1 1"), {"gc.bad:7: DS (", "found '0.0'", "other than 0"}},
      {appendix_b_with(7, "0.1 -1 0.1 1"), {"gc.bad:7: DSMIN (", "found '-1'"}},
      {appendix_b_with(7, "0.1 0 0 1"), {"gc.bad:7: DSMAX (", "found '0'"}},
      {appendix_b_with(8, "-2"), {"gc.bad:8: NTHL (", "found '-2'"}},
      {appendix_b_with(9, "0 0.0"), {"gc.bad:9: ITHL (", "found '0'"}},
      {appendix_b_with(9, "63 0.0"), {"gc.bad:", "ITHL (", "found '63'", "61 to 62"}},
      {appendix_b_with(9, "62 0.0"), {"gc.bad:10: THL(62) (", "'62' twice"}},
      {appendix_b_with(10, "62 -0.5"), {"gc.bad:10: THL(62) (", "found '-0.5'"}},
      {appendix_b_with(11, "1\n6 1.0"), {"gc.bad:12: ITHU (", "found '6'", "NDIM = 5"}},
      {appendix_b_with(12, "1\n0 1.0"), {"gc.bad:13: IUZR (", "found '0'"}},
      {appendix_b_with(12, "1\n-63 1.0"), {"gc.bad:13: IUZR (", "found '63'"}},
      {appendix_b_with(12, "1\n1 x"), {"gc.bad:13: UZR(1) (", "found 'x'"}},
      {appendix_b_with(12, "1000000000"), {"gc.bad:12: NUZR (", "'1000000000'"}},
      {appendix_b_with(13, "0 3"), {"gc.bad:13: GCIDIFF (", "found '3'", "from 0 to 2"}},
      {appendix_b_with(14, "3 1 2 0"), {"gc.bad:14: GCIPSI(3) (", "found '0'"}},
      {appendix_b_with(14, "3 1 2 4"), {"gc.bad:14: GCIPSI(3) (", "found '4'", "1 to 3"}},
      {appendix_b_with(15, "-1"), {"gc.bad:15: GCNFIXED (", "found '-1'"}},
      {appendix_b_with(16, "0"), {"gc.bad:16: GCNOSEG (", "found '0'", "from 1 to 100000"}},
      {appendix_b_with(16, "100001 100001*1"), {"gc.bad:16: GCNOSEG (", "found '100001'"}},
      {appendix_b_with(16, "2 1 3"), {"gc.bad:16: GCSEGTYP(2) (", "found '3'", "grazing contact"}},
      {appendix_b_with(17, "0 2"), {"gc.bad:17: GCFIND(1) (", "found '0'", ">= 1"}},
      {appendix_b_with(18, "1 -2"), {"gc.bad:18: GCHIND(2) (", "found '-2'"}},
      {appendix_b_with(19, "1 g2"), {"gc.bad:19: GCGIND(2) (", "found 'g2'"}},
      {appendix_b_with(20, "-1 1"), {"gc.bad:20: GCHNO(1) (", "found '-1'"}},
      {appendix_b_with(21, "2 0 1"), {"gc.bad:21: GCHGRZIND(1) (", "found '0'"}},
      {appendix_b_with(21, "3 2 1 GCHNO(2)"), {"gc.bad:21: GCHGRZIND(3) (", "found 'GCHNO(2)'"}},
      {appendix_b_with(21, "3 2 1"), {"gc.bad:21: GCHGRZIND(3) (", "found the end of the file"}},
      {first_lines(20), {"gc.bad:20: GCHNO(2) (", "found the end of the file"}},
      {first_lines(7), {"gc.bad:7: NTHL (", "found the end of the file"}},
      {appendix_b_with(16, "1 1"), {"found '2 2 1", "after the last record", "GCNOSEG"}},
      {appendix_b() + "1 1\n", {"gc.bad:22: found '1 1'", "after the last record"}},
      {appendix_b() + "GRSTOP 0\n", {"gc.bad:22: found 'GRSTOP 0'", "KEY = value"}},
      {appendix_b() + "GRSTP = 0\n", {"gc.bad:22: found 'GRSTP'", "did you mean: GRSTOP"}},
      {appendix_b() + "GRSTOP = 2\n", {"gc.bad:22: GRSTOP (", "found '2'", "0 (go on) or 1"}},
      {appendix_b() + "\nGRJUMP = 0\n", {"gc.bad:23: GRJUMP (", "found '0'"}},
      {appendix_b() + "STOP = [PD1, QQ1]\n", {"gc.bad:22: STOP (", "found 'QQ1'"}},
      {appendix_b() + "STOP = [PD1, GR1\n", {"gc.bad:22: ", "closing ']'"}},
      {appendix_b() + "NTST = 80\n", {"gc.bad:22: NTST (", "positional records"}},
      {appendix_b() + "PAR(1) = 80\n", {"gc.bad:22: PAR (", "command line"}},
  };
  CHECK(files.size() >= 45);
  check_all(files);
}

TEST_CASE("Malformed keyword files", "[constants]") {
  check_all({
      {"NDIM = 5\nICP = []", {"gc.bad:2: ICP (", "empty list"}},
      {"NDIM = 5\n", {"gc.bad: ICP (", "empty list"}},
      {"ICP = 1\nNTSTT = 5", {"gc.bad:2: found 'NTSTT'", "did you mean: NTST"}},
      {"ICP = 1\nGCFIND = [1, 2]\nGCHIND = [1]\nGCGIND = [1, 2]",
       {"gc.bad:2: ", "GCFIND has 2, GCHIND has 1, GCGIND has 2;"}},
      {"ICP = 1\nVOLTAGE = 5", {"gc.bad:2: found 'VOLTAGE'", "`tchat constants`"}},
      {"ICP = 1\nNTST = \nNCOL = 4", {"gc.bad:2: found nothing after 'NTST ='", "a value"}},
      {"ICP = 1\nNTST\n", {"gc.bad:2: found 'NTST'", "KEY = value"}},
      {"hello world", {"gc.bad:1: found 'hello world'", "KEY = value"}},
      {"ICP = 1\nNTST = [5, 6]", {"gc.bad:2: NTST (", "found '[5, 6]'"}},
      {"ICP = 1\nNTST = 5, 6", {"gc.bad:2: NTST (", "found '5, 6'"}},
      {"ICP = [1, 61", {"gc.bad:1: ", "closing ']'"}},
      {"ICP = [1,, 61]", {"gc.bad:1: ", "an empty value"}},
      {"ICP = 1,, 61", {"gc.bad:1: ", "an empty value"}},
      {"ICP = [[1], 61]", {"gc.bad:1: ICP(1) (", "found '[1]'"}},
      {"ICP = [[[[[[1]]]]]]", {"gc.bad:1: ", "nested too deeply"}},
      {"ICP = {1: 2}", {"gc.bad:1: ICP (", "a list"}},
      {"ICP(1) = 2", {"gc.bad:1: ICP (", "'ICP(1)'", "whole value"}},
      {"ICP = 1\nTHL = [61, 0]", {"gc.bad:2: THL (", "pairs"}},
      {"ICP = 1\nTHL = {61 0}", {"gc.bad:2: ", "no ':' after '61'"}},
      {"ICP = 1\nTHL = {61: }", {"gc.bad:2: ", "a value"}},
      {"ICP = 1\nTHL = {61: [1]}", {"gc.bad:2: THL(61) (", "found '[1]'"}},
      {"ICP = 1\nTHL = {7a: 1}", {"gc.bad:2: ITHL (", "found '7a'"}},
      {"ICP = 1\n\nUZR = {1:\n2,\n1: x}", {"gc.bad:5: UZR(1) (", "found 'x'"}},
      {"ICP = 1\nIRS = 'PD1", {"gc.bad:2: ", "closing quote"}},
      {"ICP = 1\nNMX = 5\nNMX = 6", {"gc.bad:3: NMX (", "given on line 2 already"}},
      {"ICP = 1\nPAR(2) = 0.5", {"gc.bad:2: PAR (", "command line"}},
      {"ICP = 1\nNICP = 2", {"gc.bad:2: NICP (", "found '2'", "allowed: 1"}},
      {"ICP = 1\nGCNOSEG = 2", {"gc.bad:2: GCFIND (", "nothing for 2 segments"}},
      {"ICP = 1\nGCHGRZIND = [[1], [2]]\nGCNOSEG = 1", {"gc.bad:2: GCHGRZIND (", "2 lists for 1 segments"}},
      {"ICP = 1\nGCHNO = [2]\nGCHGRZIND = [1]", {"gc.bad:3: GCHGRZIND (", "1 values, 2 by GCHNO"}},
      {"ICP = 1\nGCHNO = [2]\nGCHGRZIND = [[1]]", {"gc.bad:2: GCHNO(1) (", "found '2'"}},
      {"ICP = [1, 2]\nIPS = 150\nGCFIND=1 1\nGCHIND=1 1\nGCGIND=1 1\nGCSEGTYP = [2, 2]",
       {"gc.bad:6: GCSEGTYP (", "2 segments"}},
      {"ICP = 1\nIPS = 150\n", {"gc.bad:1: ICP (", "1 parameters", "at least 2"}},
  });
}

TEST_CASE("Files that are no constants files", "[constants]") {
  check_all({
      {"", {"gc.bad: found an empty file", "for example"}},
      {" \n\t\r\n\n", {"gc.bad: found an empty file"}},
      {std::string("5 180 1 1\n3 1 \0 61", 17), {"gc.bad:2: ", "no text file"}},
      {"\x7f"
       "ELF\x02\x01\x01",
       {"gc.bad:1: ", "no text file"}},
      {"\xff\xfe"
       "5\0 \0",
       {"gc.bad:1: "}},
  });
  const std::string folder = std::filesystem::temp_directory_path().string();
  CHECK(message_of([&] { read_constants_file(folder); }).find("is a directory") != std::string::npos);
  const std::string missing = folder + "/no_such_folder_of_tchat/gc.none";
  CHECK(message_of([&] { read_constants_file(missing); }) ==
        missing + ": no such constants file; give its NAME or path with -c");
}

TEST_CASE("Malformed overrides", "[constants]") {
  const std::vector<Malformed> overrides{
      {"", {"command line: found ''", "KEY=VALUE"}},
      {"NMX", {"command line: found 'NMX'", "KEY = value"}},
      {"NMX=", {"command line: found nothing after 'NMX ='"}},
      {"=5", {"command line: found '=5'"}},
      {"NMX=many", {"command line: NMX (", "found 'many'", "for example: NMX = 100"}},
      {"MNX=5", {"command line: found 'MNX'", "did you mean: NMX"}},
      {"RLO=5", {"command line: found 'RLO'", "RL0"}},
      {"DSMX=5", {"did you mean: DSMAX"}},
      {"DS=0", {"command line: DS (", "found '0'"}},
      {"ICP=1,1", {"command line: ICP(2) (", "twice"}},
      {"ICP=[mu,mu]", {"command line: ICP(2) (", "found 'mu' twice"}},
      {"ICP=1,63", {"command line: ICP(2) (", "found '63'"}},
      {"ICP(1)=2", {"command line: ICP (", "whole value"}},
      {"NICP=2", {"command line: NICP (", "found '2'", "allowed: 3, the number of values of ICP"}},
      {"UZR={1: [2.5, 3.0}", {"command line: "}},
      {"UZR={1: [2.5, 3.0]", {"command line: ", "closing '}'"}},
      {"UZR=2.5", {"command line: UZR (", "found '2.5'", "pairs"}},
      {"THL={61: -1}", {"command line: THL(61) (", "found '-1'"}},
      {"IRS=XX1", {"command line: IRS (", "found 'XX1'"}},
      {"STOP=[PD]", {"command line: STOP (", "found 'PD'"}},
      {"STOP=[PD1", {"command line: ", "closing ']'"}},
      {"GCFIND=[1,2,3]", {"command line: ", "GCFIND has 3", "GCHIND has 2 (not given here)", "GCHGRZIND has 2"}},
      {"GCFIND=[1]", {"command line: ", "GCFIND has 1", "GCGIND has 2 (not given here)"}},
      {"GCFIND=[1,2,3] GCHIND=[1,2,3] GCGIND=[1,1,1] GCHGRZIND=[[],[]]",
       {"GCFIND has 3, GCHIND has 3, GCGIND has 3, GCHGRZIND has 2;"}},
      {"omega=1.1", {"command line: found 'omega'", "'PAR(omega)=1.1'", "`tchat constants`"}},
      {"GCNOSEG=3", {"command line: ", "GCFIND", "3 segments"}},
      {"GCNOSEG=1", {"command line: GCHGRZIND (", "1 segments"}},
      {"PAR(2)=x", {"command line: PAR(2) (", "found 'x'"}},
      {"PAR(2)=inf", {"command line: PAR(2) (", "found 'inf'"}},
      {"PAR()=1", {"command line: PAR (", "found ''"}},
      {"PAR(2=1", {"command line: ", "closing parenthesis"}},
      {"PAR(0)=1", {"command line: PAR(0) (", "found '0'"}},
      {"PAR(63)=1", {"command line: PAR(63) (", "found '63'", "61 to 62"}},
      {"PAR=1", {"command line: PAR (", "pairs"}},
      {"IPS=150", {"gc.test:2: ICP (", "at least 2"}},
  };
  for (const Malformed& override_text : overrides) {
    RunSettings settings = read_constants_text(appendix_b(), "gc.test");
    const std::string message = message_of([&] {
      apply_overrides(settings, std::vector<std::string>{override_text.text});
      resolve(settings);
    });
    for (const std::string& part : override_text.expected) {
      CAPTURE(override_text.text, message, part);
      CHECK(message.find(part) != std::string::npos);
    }
  }
}
