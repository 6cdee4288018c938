# Where gsplat's own code for torch is: sourced after program.bash. $python has torch and NumPy, and the array `folders`
# names folders that hold a gsplat: those of CONIC_GSPLAT, with a colon between, or that of the installed one. Either is
# empty where there is none.

finds() { # PYTHON MODULE: the folder that the module's own lies in; importing torch takes seconds
  "$1" -c 'import importlib.util, os, sys
found = importlib.util.find_spec(sys.argv[1])
print(os.path.dirname(os.path.dirname(found.origin)) if found else "")' "$2" 2> /dev/null
}

python=
for candidate in python3 /usr/bin/python3; do
  [[ -n $(finds $candidate torch) && -n $(finds $candidate numpy) ]] && python=$candidate && break
done
IFS=: read -ra folders <<< "${CONIC_GSPLAT-$(finds "${python:-python3}" gsplat)}"
