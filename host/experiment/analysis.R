# Generalised linear mixed models of wide.csv: Rscript analysis.R, in this folder. Needs lme4.
library(lme4)
wide <- read.csv("wide.csv", colClasses = "character", na.strings = character())
wide$trials <- as.numeric(wide$trials)
keys <- c(@keys@) # in which the stimuli differ
for (key in keys) wide[[key]] <- factor(wide[[key]])
follows <- function(key, from) all(tapply(wide[[key]], wide[[from]], function(of) length(unique(of))) == 1)
for (key in keys) # as the kind of surface follows from the facets
  if (any(sapply(setdiff(keys, key), function(from) follows(key, from)))) keys <- setdiff(keys, key)
wide$count <- as.numeric(wide$@count@)
wide$other <- wide$trials - wide$count
# Subjects differ, and so do their answers to a condition (over-dispersion): random intercepts of both.
random <- if (length(unique(wide$subject)) > 1) "(1 | subject) + (1 | subject:condition)" else "(1 | condition)"
fit <- function(terms)
  glmer(as.formula(paste("cbind(count, other) ~", paste(c(terms, random), collapse = " + "))), data = wide,
        family = binomial, control = glmerControl(optimizer = "bobyqa"))
full <- fit(if (length(keys)) keys else "1")
print(summary(full))
for (key in keys) { # likelihood ratios, each key left out
  rest <- setdiff(keys, key)
  cat("\nwithout", key, "\n")
  print(anova(fit(if (length(rest)) rest else "1"), full))
}
# The same by Hamiltonian Monte Carlo:
# library(brms)
# brm(as.formula(paste("count | trials(trials) ~", paste(c(keys, "(1 | subject)"), collapse = " + "))),
#     data = wide, family = beta_binomial())
