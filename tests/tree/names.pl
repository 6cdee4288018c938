#!/usr/bin/env perl
# names.pl FOLDER MOST prints which names of a source tree mean two things: files, types, functions, header guards; and
# which rooms are crowded. Of static functions no more than MOST names may stand in more than one file.
use strict;
use warnings;

my ($root, $most_repeated) = @ARGV;
my @engine = qw(include core raster oracle lod surface judge lighting accumulation gathering source shots opencl bench cli mpi);
my $most_in_room = 45;

sub files_in {
  my ($folder) = @_;
  opendir my $entries, $folder or return ();
  my @names = sort grep { !/^\./ } readdir $entries;
  return map { -d "$folder/$_" ? files_in("$folder/$_") : "$folder/$_" } @names;
}

# A file without comments, texts and, but for those of its header guard, directives.
sub code_of {
  my ($path) = @_;
  open my $file, '<', "$root/$path" or die "$path: $!";
  local $/;
  my $code = <$file>;
  $code =~ s{/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+'}{$& =~ m{^/} ? ' ' : '""'}gse;
  my ($guard) = $code =~ /^\s*#ifndef (\w+)\n#define \1\n/;
  $code =~ s/^[ \t]*#(?:[^\n]*\\\n)*[^\n]*//mg;
  return ($code, $guard);
}

my (%files, %rooms, %types, %functions, %guards, @found);
for my $folder (@engine, qw(tests examples)) {
  for my $path (map { substr $_, 1 + length $root } files_in("$root/$folder")) {
    my ($room, $name) = $path =~ m{(.*)/(.*)};
    push @{$files{$name}}, $path if $name ne "CMakeLists.txt";
    $rooms{$room}++ if $folder ne 'tests';
    next if $name !~ /\.(?:c|h|cpp)$/ || $path =~ m{^opencl/c_library/}; # stands for the C library where there is none
    next if $path =~ /^(.*)_windows\.c$/ && -f "$root/$1_posix.c"; # which it stands for
    my ($code, $guard) = code_of($path);
    if ($name =~ /\.h$/ && $name !~ /_body\.h$/) {
      my $wanted = 'CONIC_' . uc($name =~ s/\.h$//r) . '_H';
      push @found, "$path: its header guard is not $wanted" if ($guard // '') ne $wanted;
      push @{$guards{$guard}}, $path if defined $guard;
    }
    next if $folder eq "tests" || $folder eq "examples" || $path eq "opencl/absent.c";
    my %here = map { $_ => 1 } $code =~ /\b(?:struct|union|enum)\s+(\w+)\s*\{/g;
    1 while $code =~ s/\{[^{}]*\}/;BODY;/g;
    while ($code =~ /\btypedef\b((?:[^;]|;BODY;)*);/g) {
      my $type = $1 =~ s/;BODY;/ /gr;
      next if $type =~ /^\s*(?:struct|union|enum)\s+(\w+)\s+\1\s*$/;
      $here{$1} = 1 if $type =~ /\(\s*\*\s*(\w+)\s*\)/ || $type =~ /\b(\w+)\s*(?:\([^()]*\)|(?:\[[^\]]*\]\s*)+)?\s*$/;
    }
    push @{$types{$_}}, $path for keys %here;
    my %is_static;
    while ($code =~ /(?:^|;)([\w\s*]*?)\b(\w+)\s*\([^;]*?\)(?=\s*;BODY;)/g) {
      my ($before, $function) = ($1, $2);
      $is_static{$function} = $before =~ /\bstatic\b|\b(?:CONIC_)?INLINE\b/ ? 1 : 0 if $before =~ /\w/;
    }
    push @{$functions{$is_static{$_}}{$_}}, $path for grep { $_ ne "main" } keys %is_static;
  }
}

# What the builds of kernels leave behind where there is nothing for this machine.
delete @types{qw(conic_not_this_machine)};

sub twice {
  my ($what, $names) = @_;
  push @found, map { "$what $_ stands in @{$names->{$_}}" } grep { @{$names->{$_}} > 1 } sort keys %$names;
}
twice('the file name', \%files);
twice('the type', \%types);
twice('the function', $functions{0} // {});
twice('the header guard', \%guards);
push @found, map { "the room $_ has $rooms{$_} files, more than $most_in_room" }
  grep { $rooms{$_} > $most_in_room } sort keys %rooms;

my $static = $functions{1} // {};
my @repeated = sort { @{$static->{$b}} <=> @{$static->{$a}} || $a cmp $b } grep { @{$static->{$_}} > 1 } keys %$static;
push @found, map { "the function $_ is static in @{$static->{$_}}" } grep { $functions{0}{$_} } sort keys %$static;
printf "%d of %d names of static functions stand more than once\n", scalar @repeated, scalar keys %$static;
push @found, 'more than ' . $most_repeated . ', such as ' . join ', ', map { "$_ (" . @{$static->{$_}} . ')' } grep { defined } @repeated[0 .. 9]
  if @repeated > $most_repeated;
print "$_\n" for @found;
exit(@found > 0);
