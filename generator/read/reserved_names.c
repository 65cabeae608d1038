/* SPDX-License-Identifier: MIT
 * Names that a model can't have because generated code or its compilers use them. */
#include "base/file.h"
#include "read/reader.h"

#include <ctype.h>
#include <string.h>

/* Keywords of C11, C++20 and GNU C: the runtime compiles as either language. */
static const char keyword[] =
    " alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t char32_t char8_t "
    "class co_await co_return co_yield compl concept const const_cast consteval constexpr constinit continue "
    "decltype default delete do double dynamic_cast else enum explicit export extern false float for friend goto "
    "if inline int long main mutable namespace new noexcept not not_eq nullptr operator or or_eq private "
    "protected public register reinterpret_cast requires restrict return short signed sizeof static "
    "static_assert static_cast struct switch template this thread_local throw true try typedef typeid typename "
    "typeof union unsigned using virtual void volatile wchar_t while xor xor_eq ";

/* Names that headers of the C library declare, with GNU extensions, which C++ always gets. A function with variants
 * that end in f or l is listed without the ending. Two pieces, since a longer literal is not C99. */
static const char *const library[] = {
    " BIG_ENDIAN BUFSIZ BYTE_ORDER EOF EXIT_FAILURE EXIT_SUCCESS FD_SETSIZE FILE FILENAME_MAX FOPEN_MAX "
    "FP_ILOGB0 FP_ILOGBNAN FP_INFINITE FP_INT_DOWNWARD FP_INT_TONEAREST FP_INT_TONEARESTFROMZERO "
    "FP_INT_TOWARDZERO FP_INT_UPWARD FP_LLOGB0 FP_LLOGBNAN FP_NAN FP_NORMAL FP_SUBNORMAL FP_ZERO HUGE_VAL "
    "HUGE_VALF HUGE_VALL HUGE_VAL_F128 HUGE_VAL_F32 HUGE_VAL_F32X HUGE_VAL_F64 HUGE_VAL_F64X I INFINITY "
    "INT16_MAX INT16_MIN INT16_WIDTH INT32_MAX INT32_MIN INT32_WIDTH INT64_MAX INT64_MIN INT64_WIDTH INT8_MAX "
    "INT8_MIN INT8_WIDTH INTMAX_MAX INTMAX_MIN INTMAX_WIDTH INTPTR_MAX INTPTR_MIN INTPTR_WIDTH INT_FAST16_MAX "
    "INT_FAST16_MIN INT_FAST16_WIDTH INT_FAST32_MAX INT_FAST32_MIN INT_FAST32_WIDTH INT_FAST64_MAX "
    "INT_FAST64_MIN INT_FAST64_WIDTH INT_FAST8_MAX INT_FAST8_MIN INT_FAST8_WIDTH INT_LEAST16_MAX INT_LEAST16_MIN "
    "INT_LEAST16_WIDTH INT_LEAST32_MAX INT_LEAST32_MIN INT_LEAST32_WIDTH INT_LEAST64_MAX INT_LEAST64_MIN "
    "INT_LEAST64_WIDTH INT_LEAST8_MAX INT_LEAST8_MIN INT_LEAST8_WIDTH LITTLE_ENDIAN L_ctermid L_cuserid L_tmpnam "
    "MATH_ERREXCEPT MATH_ERRNO MAXFLOAT MB_CUR_MAX M_1_PI M_2_PI M_2_SQRTPI M_E M_LN10 M_LN2 M_LOG10E M_LOG2E "
    "M_PI M_PI_2 M_PI_4 M_SQRT1_2 M_SQRT2 NAN NFDBITS NULL PDP_ENDIAN PTRDIFF_MAX PTRDIFF_MIN PTRDIFF_WIDTH "
    "P_tmpdir RAND_MAX RENAME_EXCHANGE RENAME_NOREPLACE RENAME_WHITEOUT SEEK_CUR SEEK_DATA SEEK_END SEEK_HOLE "
    "SEEK_SET SIG_ATOMIC_MAX SIG_ATOMIC_MIN SIG_ATOMIC_WIDTH SIZE_MAX SIZE_WIDTH SNAN SNANF SNANF128 SNANF32 "
    "SNANF32X SNANF64 SNANF64X SNANL TMP_MAX UINT16_MAX UINT16_WIDTH UINT32_MAX UINT32_WIDTH UINT64_MAX "
    "UINT64_WIDTH UINT8_MAX UINT8_WIDTH UINTMAX_MAX UINTMAX_WIDTH UINTPTR_MAX UINTPTR_WIDTH UINT_FAST16_MAX "
    "UINT_FAST16_WIDTH UINT_FAST32_MAX UINT_FAST32_WIDTH UINT_FAST64_MAX UINT_FAST64_WIDTH UINT_FAST8_MAX "
    "UINT_FAST8_WIDTH UINT_LEAST16_MAX UINT_LEAST16_WIDTH UINT_LEAST32_MAX UINT_LEAST32_WIDTH UINT_LEAST64_MAX "
    "UINT_LEAST64_WIDTH UINT_LEAST8_MAX UINT_LEAST8_WIDTH WCHAR_MAX WCHAR_MIN WCHAR_WIDTH WCONTINUED WEXITED "
    "WINT_MAX WINT_MIN WINT_WIDTH WNOHANG WNOWAIT WSTOPPED WUNTRACED a64l abort abs acos acosh aligned_alloc "
    "alloca arc4random arc4random_buf arc4random_uniform asctime asin asinh asprintf assert at_quick_exit atan "
    "atan2 atanh atexit atof atoi atol basename bcmp bcopy bsearch bzero calloc canonicalize "
    "canonicalize_file_name cbrt ceil clearenv clearerr clearerr_unlocked complex copysign cos cosh ctermid "
    "ctime cuserid daddl ddivl dfmal difftime div dmull dprintf drand48 drand48_data drand48_r drem dsqrtl dsubl "
    "ecvt ecvt_r erand48 erand48_r erf erfc errno exit exp exp10 exp2 explicit_bzero expm1 fabs fadd fclose "
    "fcloseall fcvt fcvt_r fd_mask fd_set fdim fdiv fdopen feof feof_unlocked ferror ferror_unlocked fflush "
    "fflush_unlocked ffma ffs ffsll fgetc fgetc_unlocked fgetpos fgetpos64 fgets fgets_unlocked fileno fileno_unlocked "
    "finite flockfile floor fma fmax fmaximum fmaximum_mag fmaximum_mag_num fmaximum_num fmaxmag fmemopen fmin "
    "fminimum fminimum_mag fminimum_mag_num fminimum_num fminmag fmod fmul fopen fopen64 fopencookie fpclassify "
    "fprintf fputc fputc_unlocked fputs fputs_unlocked fread fread_unlocked free freopen freopen64 frexp fromfp "
    "fromfpx fscanf fseek fseeko fseeko64 fsetpos fsetpos64 fsqrt fsub ftell ftello ftello64 ftrylockfile "
    "funlockfile fwrite ",
    " fwrite_unlocked gamma gcvt getc getc_unlocked getchar getchar_unlocked getdelim getenv getline getloadavg "
    "getpayload getpt gets getsubopt getw gmtime grantpt hypot ilogb imaginary index initstate initstate_r "
    "isalnum isalpha isblank iscanonical iscntrl isdigit iseqsig isfinite isgraph isgreater isgreaterequal isinf "
    "isless islessequal islessgreater islower isnan isnormal isprint ispunct issignaling isspace isunordered "
    "isupper isxdigit iszero j0 j1 jmp_buf jn jrand48 jrand48_r l64a labs lcong48 lcong48_r ldexp ldiv lgamma "
    "lgamma_r lgammaf_r lgammal_r llabs lldiv llogb llrint llround localtime log log10 log1p log2 logb longjmp "
    "lrand48 lrand48_r lrint lround malloc math_errhandling mblen mbstowcs mbtowc memccpy memchr memcmp memcpy "
    "memfrob memmem memmove mempcpy memrchr memset mkdtemp mkostemp mkostemp64 mkostemps mkostemps64 mkstemp "
    "mkstemp64 mkstemps mkstemps64 mktemp mktime modf mrand48 mrand48_r nan nearbyint nextafter nextdown "
    "nexttoward nextup noreturn nrand48 nrand48_r obstack_printf obstack_vprintf offsetof on_exit open_memstream "
    "pclose perror popen posix_memalign posix_openpt pow printf pselect ptsname ptsname_r putc putc_unlocked "
    "putchar putchar_unlocked putenv puts putw qecvt qecvt_r qfcvt qfcvt_r qgcvt qsort qsort_r quick_exit rand "
    "rand_r random random_data random_r rawmemchr realloc reallocarray realpath remainder remove remquo rename "
    "renameat renameat2 rewind rindex rint round roundeven rpmatch scalb scalbln scalbn scanf secure_getenv "
    "seed48 seed48_r select setbuf setbuffer setenv setjmp setlinebuf setpayload setpayloadsig setstate "
    "setstate_r setvbuf sigabbrev_np sigdescr_np signal signbit signgam significand sin sincos sinh snprintf "
    "sprintf sqrt srand srand48 srand48_r srandom srandom_r sscanf stderr stdin stdout stpcpy stpncpy strcasecmp "
    "strcasecmp_l strcasestr strcat strchr strchrnul strcmp strcoll strcoll_l strcpy strcspn strdup strerror "
    "strerror_l strerror_r strerrordesc_np strerrorname_np strfromd strfromf strfroml strfry strftime strlen "
    "strncasecmp strncasecmp_l strncat strncmp strncpy strndup strnlen strpbrk strrchr strsep strsignal strspn "
    "strstr strtod strtod_l strtof strtof_l strtok strtok_r strtol strtol_l strtold strtold_l strtoll_l strtoq "
    "strtoul strtoul_l strtoull_l strtouq strverscmp strxfrm strxfrm_l system tan tanh tempnam tgamma timespec "
    "timeval tmpfile tmpfile64 tmpnam tmpnam_r tolower totalorder totalordermag toupper trunc u_char u_int "
    "u_long u_short ufromfp ufromfpx uint ulong ungetc unlockpt unsetenv ushort va_arg va_end va_list va_start "
    "valloc vasprintf vdprintf vfprintf vfscanf vprintf vscanf vsnprintf vsprintf vsscanf wcstombs wctomb y0 y1 "
    "yn "};

/* Namespaces, names that GNU C predefines, and names that generated code uses. */
static const char taken[] =
    " discrete history i386 input linux output parameter port pose rate result scratch self state std time unix ";

/* True if the list, whose words have blanks around them, contains the name. */
static bool listed(const char *words, const char *name, size_t length)
{
    for (const char *word = words; *++word; word += strcspn(word, " "))
        if (!strncmp(word, name, length) && word[length] == ' ')
            return true;
    return false;
}

/* Bytes of a suffix for a number type after a function's name: f, l, or GNU's f32, f64x; 0: none. */
static size_t suffix(const char *name, size_t length)
{
    static const char *const end[] = {"f16", "f32", "f64", "f128", "f32x", "f64x", "f", "l"};
    for (size_t i = 0; i < sizeof end / sizeof *end; ++i)
        if (length > strlen(end[i]) && !memcmp(name + length - strlen(end[i]), end[i], strlen(end[i])))
            return strlen(end[i]);
    return 0;
}

/* Macros of <stdint.h>, <float.h>, <limits.h> and <math.h>: whole families. */
static bool is_macro(const char *name)
{
    static const char *const family[] = {"INT",   "UINT",        "FP_",  "M_",   "HUGE_VAL", "SEEK_", "WCHAR_",
                                         "WINT_", "SIG_ATOMIC_", "FLT_", "DBL_", "LDBL_",    "SNAN"};
    for (const char *c = name; *c; ++c)
        if (islower((unsigned char)*c) && strncmp(name, "M_", 2))
            return false;
    for (size_t i = 0; i < sizeof family / sizeof *family; ++i)
        if (!strncmp(name, family[i], strlen(family[i])))
            return true;
    return false;
}

const char *name_reserved(const char *name)
{
    const size_t length = strlen(name), end = suffix(name, length);
    if (listed(keyword, name, length))
        return "is reserved in C or C++";
    if (!strcmp(name, "gic") || !strncmp(name, "gic_", 4))
        return "belongs to the runtime";
    if (listed(taken, name, length))
        return "means something else in generated code";
    const bool typed = (end || path_ends(name, "_r") || path_ends(name, "_l")) &&
                       (!strncmp(name, "f32", 3) || !strncmp(name, "f64", 3) || !strncmp(name, "strto", 5) ||
                        !strncmp(name, "strfrom", 7) || !strncmp(name, "lgamma", 6)); /* f32addf64 */
    if ((length > 2 && !strcmp(name + length - 2, "_t")) || typed || is_macro(name) ||
        listed(library[0], name, length) || listed(library[1], name, length) ||
        listed(library[0], name, length - end) || listed(library[1], name, length - end))
        return "belongs to the C library";
    return NULL;
}
