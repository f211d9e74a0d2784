# What zsh offers for command lines of rayloc: a line "COMMAND LINE: WORDS" each. Loaded from $fpath
# by compinit, as an installed completion is, in a terminal of its own.
#   zsh -f completion.zsh RAYLOC WORK_FOLDER
set -eu
zmodload zsh/zpty
rayloc=$1
work=$2
mkdir -p $work/functions $work/folder
$rayloc completion zsh >$work/functions/_rayloc
: >$work/folder/only-file
verbs=($($rayloc --help | sed -n '/^Subcommands:/,/^$/ s/^  \([a-z][a-z-]*\) .*/\1/p'))

# compadd is what offers words: those of the line's own completion are written down instead.
cat >$work/rc <<RC
fpath=($work/functions \$fpath)
PATH=${rayloc:h}:\$PATH
autoload -Uz compinit
compinit -u -D
cd $work/folder
unsetopt AUTO_LIST  # a list that is longer than the screen would ask first, and take the next line for the answer
RC
cat >>$work/rc <<'RC'
compadd() {
  local -a found
  case " $* " in (*' -O '*|*' -A '*|*' -D '*) builtin compadd "$@"; return ;; esac
  builtin compadd -O found "$@"
  print -rn -- " ${found[*]}" >>$OFFERED
  builtin compadd "$@"
}
complete-line() {
  BUFFER=$LINE
  CURSOR=$#BUFFER
  zle complete-word
  print >$OFFERED.done
}
zle -C complete-word complete-word _main_complete
zle -N complete-line
bindkey '^X' complete-line
PROMPT=
RC
zpty shell "TERM=dumb zsh -f -i"
zpty -w shell "source $work/rc"

lines=('rayloc ' 'rayloc scene ' 'rayloc replay site --kind ' 'rayloc completion '
       'rayloc replay --out ')
for verb in $verbs; do
  lines+=("rayloc $verb -")
done
for line in $lines; do
  : >$work/offered
  rm -f $work/offered.done
  zpty -w shell "OFFERED=$work/offered LINE='$line'"
  zpty -w -n shell $'\C-x'
  # The tests' own time limit ends a wait for what never comes.
  until [[ -e $work/offered.done ]]; do
    zpty -r -t shell chunk || :
    sleep 0.02
  done
  zpty -w -n shell $'\C-u'
  print -r -- "$line:$(<$work/offered)"
done
zpty -d shell
