#!/usr/bin/env perl
# circles.pl FOLDER… prints the files of these folders whose functions call each other in a circle, and by which
# functions. A function that is named counts as called.
use strict;
use warnings;

sub sources_in {
  my ($folder) = @_;
  opendir my $entries, $folder or return ();
  my @names = sort grep { !/^\./ } readdir $entries;
  return map { -d "$folder/$_" ? sources_in("$folder/$_") : /\.c$/ ? "$folder/$_" : () } @names;
}

# Without comments, texts and directives.
sub code_of {
  my ($path) = @_;
  open my $file, '<', $path or die "$path: $!";
  local $/;
  my $code = <$file>;
  $code =~ s{/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+'}{$& =~ m{^/} ? ' ' : '""'}gse;
  $code =~ s/^[ \t]*#(?:[^\n]*\\\n)*[^\n]*//mg;
  return $code;
}

# Of each file its functions with their bodies; of each that others see, the files that it stands in.
my (%body, %places);
for my $path (map { sources_in($_) } @ARGV) {
  my $code = code_of($path);
  while ($code =~ /^(\w[\w\s*]*?)\b(\w+)\s*(\((?:[^(){};]|\([^(){};]*\))*\))\s*(\{(?:[^{}]|(?4))*\})/mg) {
    my ($before, $function, $text) = ($1, $2, $4);
    $body{$path}{$function} = $text;
    $places{$function}{$path} = 1 if $before !~ /\bstatic\b/;
  }
}

my (%calls, %reach);
for my $path (keys %body) {
  for my $function (sort keys %{$body{$path}}) {
    my %words = map { $_ => 1 } $body{$path}{$function} =~ /(?<![.\w])(?<!->)(\w+)/g;
    for my $called (grep { $places{$_} && !$body{$path}{$_} } keys %words) {
      push @{$calls{$path}{$_}}, "$function calls $called" for keys %{$places{$called}};
    }
  }
}
for my $from (keys %calls) {
  my @open = ($from);
  while (defined(my $path = pop @open)) {
    push @open, grep { !$reach{$from}{$_}++ } keys %{$calls{$path}};
  }
}

my %circles;
for my $path (grep { $reach{$_}{$_} } keys %calls) {
  $circles{join ' ', sort grep { $reach{$path}{$_} && $reach{$_}{$path} } keys %calls} = 1;
}
for my $circle (sort keys %circles) {
  my @files = split / /, $circle;
  print "files in a circle: $circle\n";
  for my $from (@files) {
    for my $to (grep { $calls{$from}{$_} } @files) {
      print "  $from to $to: ", join(', ', sort @{$calls{$from}{$to}}), "\n";
    }
  }
}
printf "%d functions of %d files\n", scalar(map { keys %$_ } values %body), scalar keys %body;
exit(%circles ? 1 : 0);
