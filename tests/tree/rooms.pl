#!/usr/bin/env perl
# Who includes whom. rooms.pl breaches FOLDER prints what in a source tree breaks the rules, rooms.pl draw FOLDER the
# rooms of the engine and the program as a Mermaid drawing.
use strict;
use warnings;

# The folders that each folder may include from, besides its own.
my %may_include = (
  'include/conic' => [],
  core => [qw(conic)],
  raster => [qw(conic core)],
  oracle => [qw(conic core)],
  judge => [qw(conic core raster oracle gaussians)],
  lod => [qw(conic core raster surface gaussians)],
  accumulation => [qw(conic core raster gaussians lod)],
  gathering => [qw(conic core raster)],
  surface => [qw(conic core)],
  gaussians => [qw(conic core)],
  lighting => [qw(conic core raster lod gaussians accumulation)],
  source => [qw(conic core raster lod surface gaussians)],
  opencl => [qw(conic core raster lod gaussians)],
  shots => [qw(conic core raster lighting source accumulation gathering)],
  cli => [qw(conic core raster lod surface gaussians lighting judge source opencl accumulation gathering shots)],
  bench => [qw(conic core raster lod surface gaussians lighting source opencl accumulation gathering shots cli tests)],
  mpi => [qw(conic core shots cli)],
  examples => [qw(conic)],
  tests => [qw(conic core raster oracle lod surface gaussians lighting judge source opencl accumulation gathering shots cli mpi bench)],
);
my @library = qw(include core raster oracle lod surface gaussians lighting judge source opencl accumulation gathering shots);
my %is_folder = map { s{.*/}{}r => 1 } keys %may_include;

# Rooms that still include each other in a circle. A circle that is gone must leave the list.
my @circles = ();

# Calls that the library leaves to others: output, the end of the program, memory past the context, state of the whole
# process, and mathematics whose last bit depends on the machine. A bridge is a module in a process of its own.
my @calls = (
  qw(printf vprintf puts putchar perror),
  qw(exit _exit abort atexit signal setlocale srand rand),
  qw(malloc calloc realloc aligned_alloc posix_memalign strdup strndup free),
  qw((?:sin|cos|tan|asin|acos|atan|atan2|sincos|sinh|cosh|tanh|asinh|acosh|atanh)[fl]?),
  qw((?:exp|exp2|exp10|expm1|log|log2|log10|log1p|pow|cbrt|hypot|erf|erfc|tgamma|lgamma|ldexp|fma|fmod)[fl]?),
  qw(strtod strtof strtold atof sscanf fscanf scanf),
);
my $calls = join '|', @calls;
my $forbidden = qr/\b(?:$calls)\s*\(|\bf(?:printf|puts|putc|write)\s*\([^;\n]*\bstd(?:out|err)\b|\bstderr\b/;

# A file with comments and texts blanked, lines as they were; includes keep theirs.
sub code_of {
  my ($path) = @_;
  open my $file, '<', $path or die "$path: $!";
  local $/;
  my $code = <$file>;
  $code =~ s{(/\*.*?\*/|//[^\n]*)|(#\s*include\s*"[^"\n]*")|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+'}
            {defined $2 ? $2 : defined $1 ? "\n" x ($1 =~ tr/\n//) : '""'}gse;
  return $code;
}

sub sources_in {
  my ($folder) = @_;
  opendir my $entries, $folder or return ();
  my @names = sort grep { !/^\./ } readdir $entries;
  return map { -d "$folder/$_" ? sources_in("$folder/$_") : /\.(?:c|h|cpp)$/ ? "$folder/$_" : () } @names;
}

my ($verb, $root) = @ARGV;
my (%code, %included, %room_of);
for my $folder (keys %may_include) {
  for my $path (sources_in("$root/$folder")) {
    my $file = substr $path, 1 + length $root;
    $code{$file} = code_of($path);
    $included{$file} = [$code{$file} =~ m{^\s*#\s*include\s*["<]([a-z]+/[^">]+)[">]}mg];
    $room_of{$file} = $file =~ m{(.*)/} ? $1 : '';
  }
}

# Of each room of the library, the program and the benches, which it includes, and from which file.
my %rooms;
for my $file (grep { !m{^(?:tests|examples)/} } sort keys %code) {
  $rooms{$room_of{$file}} //= {};
  for my $included (map { /^conic\// ? "include/$_" : $_ } @{$included{$file}}) {
    my $room = $room_of{$included};
    $rooms{$room_of{$file}}{$room} //= "$file includes $included"
      if defined $room && $room ne $room_of{$file} && $room !~ /^tests\b/;
  }
}
my %reach;
for my $from (keys %rooms) {
  my @open = ($from);
  while (defined(my $room = pop @open)) {
    push @open, grep { !$reach{$from}{$_}++ } keys %{$rooms{$room}};
  }
}

sub circles {
  my %found;
  for my $room (grep { $reach{$_}{$_} } keys %rooms) {
    $found{join ' ', sort grep { $reach{$room}{$_} && $reach{$_}{$room} } keys %rooms} = 1;
  }
  return sort keys %found;
}

sub breaches {
  my @found;
  for my $file (sort keys %code) {
    my $folder = $file =~ m{^include/conic/} ? 'include/conic' : $file =~ s{/.*}{}r;
    my %allowed = map { $_ => 1 } $folder =~ s{.*/}{}r, @{$may_include{$folder}};
    for my $included (@{$included{$file}}) {
      my $other = $included =~ s{/.*}{}r;
      push @found, "$file may not include $included" if $is_folder{$other} && !$allowed{$other};
    }
    next if $file =~ m{^core/base/context\.c$|_bridge\.c$} || !grep { $file =~ m{^$_/} && $_ ne 'include' } @library;
    while ($code{$file} =~ /$forbidden/g) {
      my $line = 1 + (substr($code{$file}, 0, $-[0]) =~ tr/\n//);
      push @found, "$file:$line: the library may not call $&";
    }
  }
  my %circles = map { $_ => 1 } circles();
  my %listed = map { $_ => 1 } @circles;
  for my $circle (grep { !$listed{$_} } keys %circles) {
    my @rooms = split / /, $circle;
    push @found, "rooms in a circle: $circle";
    for my $from (@rooms) {
      push @found, map { "  $rooms{$from}{$_}" } grep { $rooms{$from}{$_} } @rooms;
    }
  }
  if (-d "$root/tests/tree") {
    push @found, map { "no circle any more, take it off the list: $_" } grep { !$circles{$_} } @circles;
  }
  return @found;
}

# Includes that others imply are left out.
sub draw {
  my (%folders, @lines);
  push @{$folders{s{/.*}{}r}}, $_ for sort keys %rooms;
  for my $folder (sort keys %folders) {
    push @lines, "  subgraph folder_$folder" . "[$folder]", map({ '    ' . tr{/}{_}r . "[\"$_\"]" } @{$folders{$folder}}), '  end';
  }
  for my $from (sort keys %rooms) {
    for my $to (sort keys %{$rooms{$from}}) {
      my $is_implied = grep { $_ ne $to && !$reach{$_}{$from} && !$reach{$to}{$_} && $reach{$_}{$to} } keys %{$rooms{$from}};
      push @lines, '  ' . $from =~ tr{/}{_}r . ' --> ' . $to =~ tr{/}{_}r if !$is_implied;
    }
  }
  return ('flowchart TD', @lines);
}

my @lines = $verb eq 'draw' ? draw() : breaches();
print "$_\n" for @lines;
exit($verb ne 'draw' && @lines > 0);
