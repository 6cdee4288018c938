#!/usr/bin/env perl
# names.pl FOLDER prints which names of a source tree mean two things: files, types, functions, header guards; which
# static functions of one name do the same; and which rooms are crowded.
use strict;
use warnings;

my ($root) = @ARGV;
my @engine = qw(include core raster oracle lod surface gaussians judge lighting accumulation gathering source shots opencl bench cli
  mpi);
my $most_in_room = 45;
my $is_static = qr/\bstatic\b|\b(?:CONIC_)?INLINE\b/;

sub files_in {
  my ($folder) = @_;
  opendir my $entries, $folder or return ();
  my @names = sort grep { !/^\./ } readdir $entries;
  return map { -d "$folder/$_" ? files_in("$folder/$_") : "$folder/$_" } @names;
}

# A file without comments and, but for those of its header guard, directives; texts are numbers in quotes.
sub code_of {
  my ($path) = @_;
  open my $file, '<', "$root/$path" or die "$path: $!";
  local $/;
  my $code = <$file>;
  $code =~ s{/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+'}{$& =~ m{^/} ? ' ' : '"' . unpack('H*', $&) . '"'}gse;
  my ($guard) = $code =~ /^\s*#(?:ifndef (\w+)\n#define \1|pragma (once))\n/ ? $1 // $2 : ();
  my @macros = $code =~ /^[ \t]*#[ \t]*define[ \t]+(\w+)/mg;
  $code =~ s/^[ \t]*#(?:[^\n]*\\\n)*[^\n]*//mg;
  return ($code, $guard, @macros);
}

# A function's parameters and body, whatever the parameters are called and however it is laid out.
sub deed_of {
  my ($parameters, $body) = @_;
  my $i = 0;
  for (split /,/, $parameters) {
    my ($name) = /(\w+)\s*(?:\[[^\]]*\]\s*)*\)?\s*$/ or next;
    my $place = '@' . $i++;
    $parameters =~ s/\b$name\b(?=\s*[\[,)])/$place/;
    $body =~ s/(?<![.>])\b$name\b/$place/g;
  }
  my $deed = "$parameters $body" =~ s/\s+/ /gr;
  return $deed =~ s/(?<!\w) | (?!\w)//gr;
}

my (%files, %rooms, %types, %functions, %deeds, %own, @found);
for my $folder (@engine, qw(tests examples)) {
  for my $path (map { substr $_, 1 + length $root } files_in("$root/$folder")) {
    my ($room, $name) = $path =~ m{(.*)/(.*)};
    push @{$files{$name}}, $path if $name ne "CMakeLists.txt" && $path !~ m{^bench/\w+/run$};
    $rooms{$room}++ if $folder ne 'tests';
    next if $name !~ /\.(?:c|h|cpp)$/ || $path =~ m{^opencl/c_library/}; # stands for the C library where there is none
    next if $path =~ /^(.*)_(?:windows|absent)\.c$/ && -f "$root/$1_posix.c"; # which it stands for
    my ($code, $guard, @macros) = code_of($path);
    if ($name =~ /\.h$/ && $name !~ /_body\.h$/) {
      my $wanted = 'CONIC_' . uc($name =~ s/\.h$//r) . '_H';
      push @found, "$path: its header guard is not $wanted"
        if ($guard // '') ne $wanted && (($guard // '') ne 'once' || $folder eq 'include');
    }
    next if $folder eq "tests" || $folder eq "examples" || $path eq "opencl/absent.c";
    while ($code =~ /(?:^|(?<=[;}]))([\w\s*]*?)\b(\w+)\s*(\([^;{}]*?\))\s*(\{(?:[^{}]++|(?4))*\})/g) {
      my ($before, $function, $parameters, $body) = ($1, $2, $3, $4);
      push @{$deeds{$function}{deed_of($parameters, $body)}}, $path if $before =~ $is_static;
    }
    $own{$path}{$_} = 1 for @macros, map { /\b([A-Z]\w*)\b/g } $code =~ /\benum\b[^{};]*\{([^}]*)\}/g;
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
      $is_static{$function} = $before =~ $is_static ? 1 : 0 if $before =~ /\w/;
    }
    push @{$functions{$is_static{$_}}{$_}}, $path for grep { $_ ne "main" } keys %is_static;
    $own{$path}{$_} = 1 for grep { $is_static{$_} } keys %is_static;
  }
}

sub twice {
  my ($what, $names) = @_;
  push @found, map { "$what $_ stands in @{$names->{$_}}" } grep { @{$names->{$_}} > 1 } sort keys %$names;
}
twice('the file name', \%files);
twice('the type', \%types);
twice('the function', $functions{0} // {});
push @found, map { "the room $_ has $rooms{$_} files, more than $most_in_room" }
  grep { $rooms{$_} > $most_in_room } sort keys %rooms;

my $static = $functions{1} // {};
push @found, map { "the function $_ is static in @{$static->{$_}}" } grep { $functions{0}{$_} } sort keys %$static;

# One deed under one name in two files; but where it names what each file has for itself, it need not be one.
for my $function (sort keys %deeds) {
  for my $deed (sort keys %{$deeds{$function}}) {
    my @paths = @{$deeds{$function}{$deed}};
    my %named = map { $_ => 1 } $deed =~ /\b([A-Za-z_]\w*)\b/g;
    my @shared = grep { my $path = $_; !grep { $own{$path}{$_} } keys %named } @paths;
    push @found, "the function $function does the same in @shared" if @shared > 1;
  }
}
print "$_\n" for @found;
exit(@found > 0);
