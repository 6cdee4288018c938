#!/usr/bin/env bash
# The pages hold together: links lead somewhere, the index has every page, sources cite pages that are there, lines are
# wrapped, and the reference, and all pages but the notes together, stay short. Every rule is first tried on a tree that
# breaks it.
set -euo pipefail

source_folder=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

most_words=60350
most_of_reference=43700

# Prints every breach in the tree FOLDER.
breaches() {
  perl - "$1" "$most_words" "$most_of_reference" << 'END'
use strict;
use warnings;
use File::Find;
use open qw(:std :encoding(UTF-8));

my ($root, $most_words, $most_of_reference) = @ARGV;
chdir $root or die;
my (@pages, @sources);
find({ no_chdir => 1, wanted => sub {
    my $name = $_ eq '.' ? '' : substr $_, 2;
    $File::Find::prune = 1 if $name =~ m{^(build[^/]*|out|\.git)$};
    return unless -f;
    push @pages, $name if $name =~ /\.md$/;
    push @sources, $name if $name =~ /\.(c|h|cpp|cl|sh|bash|py|cmake|txt)$/ || $name =~ m{^scripts/};
} }, '.');

sub text_of {
  open my $file, '<', $_[0] or die "$_[0]: $!";
  local $/;
  return scalar <$file>;
}

# The anchors that a page's headings have, as web pages make them.
sub anchors {
  my ($text, %found) = @_;
  $text =~ s/^```.*?^```//msg;
  while ($text =~ /^#+ (.*)/mg) {
    my $anchor = lc $1;
    $anchor =~ s/[^\w\- ]//g;
    $anchor =~ s/ /-/g;
    $found{$anchor} = 1;
  }
  return \%found;
}

my ($n_words, $n_of_reference) = (0, 0);
my %indexed;
for my $page (sort @pages) {
  my $text = text_of($page);
  my ($folder) = $page =~ m{^(.*/)?[^/]*$};
  my $is_note = $page =~ m{^docs/notes/};
  # Tables that a script writes are looked up, not read: their words are not counted.
  my $n_of_page = () = $text =~ /\S+/g;
  $n_of_page = 0 if $text =~ /^\*Made by `scripts\/[^`]+`: do not edit\.\*/m;
  $n_words += $n_of_page unless $is_note;
  $n_of_reference += $n_of_page if $page =~ m{^docs/reference/};
  (my $prose = $text) =~ s/^```.*?^```$/"\n" x (() = $& =~ m{\n}g)/msge;
  my $i_line = 0;
  for my $line (split /\n/, $prose) {
    $i_line++;
    next if $is_note || $line =~ /^\s*(\||!\[|    )/ || length $line <= 120;
    print "$page:$i_line: over 120 columns\n";
  }
  $prose =~ s/`[^`\n]*`//g;
  while ($prose =~ /\]\(([^)\s]+)\)/g) {
    my $link = $1;
    my ($path, $anchor) = split /#/, $link, 2;
    next if $path =~ /^[a-z]+:/;
    my $target = $path eq '' ? $page : ($folder // '') . $path;
    1 while $target =~ s{[^/]+/\.\./}{};
    $indexed{$target} = 1 if $page eq 'docs/README.md';
    if (!-e $target) {
      print "$page: $link leads nowhere\n";
    } elsif (defined $anchor && !anchors(text_of($target))->{$anchor}) {
      print "$page: $link has no such heading\n";
    }
  }
}
for my $page (grep { m{^docs/} && $_ ne 'docs/README.md' && !$indexed{$_} } sort @pages) {
  print "$page is not in the index, docs/README.md\n";
}
print "the pages but the notes have $n_words words; at most $most_words\n" if $n_words > $most_words;
print "the reference has $n_of_reference words; at most $most_of_reference\n" if $n_of_reference > $most_of_reference;

for my $source (sort @sources) {
  my $text = text_of($source);
  while ($text =~ m{(?<![\w/.])(docs/[\w\-./]*\w)}g) {
    print "$source: $1 is not there\n" unless -e $1 || $source =~ m{^tests/tree/docs\.sh$};
  }
}
END
}

# Each rule sees a breach of it.
mkdir -p "$work/docs/notes" "$work/core"
cd "$work"
expect() { # TEXT
  [[ $(breaches "$work") == *"$1"* ]] || {
    echo "FAILED: nothing was said of: $1"
    exit 1
  }
}
printf '# A page\n\n[there](docs/a.md#a-heading) and [here](#a-page)\n' > README.md
printf '[a](a.md), [b](notes/b.md), [d](d.md)\n' > docs/README.md
fence="\`\`\`"
printf '# Title\n\n## A heading\n\n[up](../README.md)\n\n%s\n%0200d\n[no](link)\n%s\n' $fence 0 $fence > docs/a.md
printf '%0200d\n' 0 > docs/notes/b.md
touch docs/d.md
printf '/* docs/a.md */\n' > core/c.c
[[ -z $(breaches "$work") ]] || {
  echo "FAILED: of a sound tree: $(breaches "$work")"
  exit 1
}
printf '[gone](b.md)\n' > docs/d.md
expect 'docs/d.md: b.md leads nowhere'
printf '[gone](a.md#other)\n' > docs/d.md
expect 'docs/d.md: a.md#other has no such heading'
printf '%0121d\n' 0 > docs/d.md
expect 'docs/d.md:1: over 120 columns'
seq $((most_words + 1)) > docs/d.md
expect "words; at most $most_words"
mkdir docs/reference
seq $((most_of_reference + 1)) > docs/reference/e.md
expect "words; at most $most_of_reference"
rm -r docs/reference
printf '/* docs/b.md, see there */\n' > core/c.c
expect 'core/c.c: docs/b.md is not there'

printf '[a](a.md)\n' > docs/README.md
expect 'docs/d.md is not in the index'

found=$(breaches "$source_folder")
[[ -z $found ]] || {
  echo "FAILED:"
  echo "$found"
  exit 1
}
