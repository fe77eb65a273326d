# Writes OUT, a source file with a checksum of the sources in FILES (a list separated by |): what simulated runs depend
# on. Kept runs of another simulator are not used.
string(REPLACE "|" ";" files "${FILES}")
list(SORT files)
set(all "")
foreach(f ${files})
  file(SHA256 ${f} sum)
  string(APPEND all ${sum})
endforeach()
string(SHA256 stamp "${all}")
file(WRITE ${OUT} "namespace supercircle::diagnosis {\nconst char* simulatorStamp();\nconst char* simulatorStamp() {\n    return \"${stamp}\";\n}\n} // namespace supercircle::diagnosis\n")
