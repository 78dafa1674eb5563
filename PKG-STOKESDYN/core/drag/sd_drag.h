/* The drag of water on a lone sphere or grain, and what its neighbours add to it.
 *
 * With w the velocity of the water past the grain (between the grains), a its radius and Re = 2 a
 * rho |w|/eta,
 *   F = pi a eta/4  N(Re')  h  w,    N(Re) = Re C_d(Re), 24 for Re -> 0 (Stokes)
 *
 * Law                 N(Re)                                            of what
 *   yade              24.4 + 0.44 Re                                   Dallavalle's form
 *   schiller_naumann  24 (1 + 0.15 Re^0.687); 0.44 Re where that is more (Re > 989)
 *   brown_lawler      24 (1 + 0.15 Re^0.681) + 0.407 Re/(1 + 8710/Re)  spheres, Re to 2e5
 *   ferguson_church   (sqrt(Re) + sqrt(Re + 96))^2/4                   natural sand (C_1 18, C_2
 *                  1)
 *
 * Laws of beds have their neighbours in them: F = 6 pi a eta f w, with e = 1 - phi, Re_s = e Re
 *   ergun       150 phi/(18 e^2) + 1.75 Re/(18 e)                    packed beds; no drag of lone
 *                  grains
 *   gidaspow    ergun for e <= 0.8, else (N(Re_s)/24) e^-3.65, N of schiller_naumann (Wen & Yu)
 *   beetstra    10 phi/e^2 + e^2 (1 + 1.5 phi^(1/2)) + 0.413 Re_s/(24 e^2)
 *                 (1/e + 3 phi e + 8.4 Re_s^-0.343)/(1 + 10^(3 phi) Re_s^(-(1 + 4 phi)/2))
 *   koch_hill   e (F_0 + F_3 Re_s/2),  F_3 = 0.0673 + 0.212 phi + 0.0232/e^5, F_0 = 10 phi/e^3 for
 *                 phi >= 0.4, else (1 + 3 (phi/2)^(1/2) + 135/64 phi ln phi + 16.14 phi)
 *                                  /(1 + 0.681 phi - 8.48 phi^2 + 8.16 phi^3)
 * They are published for the drag without the pressure gradient of the flow itself, e F, or,
 * Ergun's, for the pressure drop of a fixed bed, F phi/V.
 *
 * Hindrance, e = 1 - phi       Re'                  h
 *   power                      Re                   e^-n, n given
 *   richardson_zaki            Re_0: Re e^(1-n(Re_0))   e^(1-n(Re_0))
 *   di_felice                  e Re                 e^-beta(e Re)
 * Richardson & Zaki measured that the volume of grains and water past each other, per area, is e w
 * = w_0 e^n where a lone grain falls with w_0: so the drag at w is that of a lone grain at w_0 = w
 * e^(1-n), and n is that of Re_0 = 2 a rho w_0/eta, as they have it but for the steps between its
 * parts: 4.4 Re_0^-0.03 below Re_0 = 1, 4.4 Re_0^-0.1 above, within 4.65 and 2.39. Di Felice: beta
 * = 3.7 - 0.65 exp(-(1.5 - log10 Re')^2/2). A grain that is no sphere falls as a sphere of its
 * density does whose diameter is `fall` times its own: it has the drag of that sphere per volume,
 * fall^-3 F(fall a). All of F acts beside the buoyancy of the clear fluid, rho g V: what the
 * water's own excess pressure does to a grain is in h. (Di Felice's exponent is for a drag beside
 * the buoyancy of the mixture, e times as large: there it is h = e^(1-beta).)
 *
 * Sources: Dallavalle 1948; Schiller & Naumann 1933; Brown & Lawler 2003 (J. Environ. Eng. 129);
 * Ferguson & Church 2004 (J. Sediment. Res. 74); Richardson & Zaki 1954 (Trans. Inst. Chem. Eng.
 * 32); Di Felice 1994 (Int. J. Multiphase Flow 20); Ergun 1952 (Chem. Eng. Prog. 48); Wen & Yu
 * 1966; Gidaspow 1994 (Multiphase flow and fluidization); Hill, Koch & Ladd 2001 (J. Fluid Mech.
 * 448); Beetstra, van der Hoef & Kuipers 2007 (AIChE J. 53). */
#ifndef SD_DRAG_H
#define SD_DRAG_H

#include "sd_constants.h"
#include "sd_extern_c.h"

SD_BEGIN_C

typedef enum {
  SD_DRAG_YADE,
  SD_DRAG_SCHILLER_NAUMANN,
  SD_DRAG_BROWN_LAWLER,
  SD_DRAG_FERGUSON_CHURCH,
  SD_DRAG_ERGUN,
  SD_DRAG_GIDASPOW,
  SD_DRAG_BEETSTRA,
  SD_DRAG_KOCH_HILL
} sd_drag_of_one;

typedef enum {
  SD_HINDRANCE_POWER,
  SD_HINDRANCE_RICHARDSON_ZAKI,
  SD_HINDRANCE_DI_FELICE,
  /* of the laws of beds, and of these alone */
  SD_HINDRANCE_OWN
} sd_drag_of_many;

/* Zeros: Yade's law with a power of the porosity. */
typedef struct {
  sd_drag_of_one law;
  sd_drag_of_many hindrance;
  /* fall diameter over diameter; 0: 1 */
  double fall;
} sd_drag_law;

/* Is it a law of beds? */
static inline int sd_drag_of_bed(sd_drag_of_one law)
{
  return law >= SD_DRAG_ERGUN;
}

/* N(Re), Re >= 0, of a law of lone grains. */
double sd_drag_number(sd_drag_of_one law, double Re);

/* What the places with these phi do to the drag of the grains there: e^-exponent where the
 * hindrance is a power, otherwise e = 1 - phi itself. Once per place instead of once per grain.
 * phi, hindrance [n] */
void sd_hindrance_of(sd_drag_law law, int n, const double *phi, double exponent, double *hindrance);

/* F/w of a grain of radius a for the speed |w|, of any law; hindrance: that of its place. */
double sd_drag_by_law(sd_drag_law law, double rho, double eta, double a, double hindrance,
                      double speed);

/* The same; Yade's law with a power on the spot. */
static inline double sd_drag_factor(sd_drag_law law, double rho, double eta, double a,
                                    double hindrance, double speed)
{
  if (law.law == SD_DRAG_YADE && law.hindrance == SD_HINDRANCE_POWER && law.fall == 0.0)
    return 0.5 * SD_PI * a * (0.44 * rho * a * speed + 12.2 * eta) * hindrance;
  return sd_drag_by_law(law, rho, eta, a, hindrance, speed);
}

/* dF/dw of the same: between F/w and twice that. */
double sd_drag_slope(sd_drag_law law, double rho, double eta, double a, double hindrance,
                     double speed);

/* The speed at which a lone grain falls or rises: the drag balances the force >= 0 on it, its
 * weight less that of the water in its place. Not by ergun, which has no drag of lone grains. */
double sd_fall_speed(sd_drag_law law, double rho, double eta, double a, double force);

SD_END_C
#endif
