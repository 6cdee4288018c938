#include <assimp/material.h>
#include <stdlib.h>
#include <string.h>

#include "core/assimp/assimp_writer_bridge.h"

enum { BLOCK = 1024 };

static const char *name_in(const char *path) {
  const char *name = path;
  for (const char *c = path; *c; c++)
    if (*c == '/' || *c == '\\')
      name = c + 1;
  return name;
}

/* A texture within the file: "*I", or by its name; null where it is a file of its own. */
static const struct aiTexture *find_embedded(const struct aiScene *scene, const char *path) {
  if (path[0] == '*') {
    unsigned long i = strtoul(path + 1, NULL, 10);
    return i < scene->mNumTextures ? scene->mTextures[i] : NULL;
  }
  for (unsigned i = 0; i < scene->mNumTextures; i++)
    if (path[0] && strcmp(name_in(scene->mTextures[i]->mFilename.data), name_in(path)) == 0)
      return scene->mTextures[i];
  return NULL;
}

static void send_texels(conic_assimp_writer *w, conic_assimp_record record, const struct aiTexture *texture) {
  unsigned char block[BLOCK][4];
  size_t n = (size_t)texture->mWidth * texture->mHeight;
  record.picture = CONIC_ASSIMP_TEXELS;
  record.width = texture->mWidth;
  record.height = texture->mHeight;
  record.n_bytes = 4 * n;
  conic_assimp_send_bytes(w, &record, sizeof record);
  for (size_t done = 0, m; done < n; done += m) {
    m = n - done < BLOCK ? n - done : BLOCK;
    for (size_t i = 0; i < m; i++) {
      const struct aiTexel *texel = &texture->pcData[done + i];
      block[i][0] = texel->r;
      block[i][1] = texel->g;
      block[i][2] = texel->b;
      block[i][3] = texel->a;
    }
    conic_assimp_send_bytes(w, block, 4 * m);
  }
}

/* The first of the kinds of textures that give the surface's own colour. */
static int find_texture(const struct aiMaterial *material, struct aiString *path, unsigned *i_coordinate,
                        int *is_clamped) {
  static const enum aiTextureType types[] = {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE};
  for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
    enum aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    *i_coordinate = 0;
    memset(path, 0, sizeof *path);
    if (aiGetMaterialTexture(material, types[i], 0, path, NULL, i_coordinate, NULL, NULL, modes, NULL) ==
            aiReturn_SUCCESS &&
        path->data[0]) {
      *is_clamped = modes[0] == aiTextureMapMode_Clamp;
      return 1;
    }
  }
  return 0;
}

/* Where a file says nothing, Assimp fills in white. */
static int is_default(const struct aiMaterial *material) {
  struct aiString name = {0};
  aiGetMaterialString(material, AI_MATKEY_NAME, &name);
  return strcmp(name.data, AI_DEFAULT_MATERIAL_NAME) == 0;
}

/* A texture replaces the colour. */
static void find_material_color(const struct aiMaterial *material, int has_texture, float color[3]) {
  struct aiColor4D found = {1.0f, 1.0f, 1.0f, 1.0f};
  color[0] = color[1] = color[2] = 1.0f;
  if (is_default(material) || has_texture)
    return;
  if (aiGetMaterialColor(material, AI_MATKEY_BASE_COLOR, &found) != aiReturn_SUCCESS &&
      aiGetMaterialColor(material, AI_MATKEY_COLOR_DIFFUSE, &found) != aiReturn_SUCCESS)
    return;
  color[0] = (float)found.r;
  color[1] = (float)found.g;
  color[2] = (float)found.b;
}

/* A wholly invisible material is a mistake of the file. */
static void find_opacity(const struct aiMaterial *material, conic_assimp_record *record) {
  ai_real opacity = 1;
  record->opacity = 1.0f;
  if (!is_default(material) && aiGetMaterialFloat(material, AI_MATKEY_OPACITY, &opacity) == aiReturn_SUCCESS)
    record->opacity = (float)opacity;
}

static void send_material(conic_assimp_writer *w, const struct aiMaterial *material) {
  conic_assimp_record record = {.type = CONIC_ASSIMP_MATERIAL};
  struct aiString path;
  unsigned i_coordinate;
  int is_clamped = 0, has_texture = find_texture(material, &path, &i_coordinate, &is_clamped);
  find_material_color(material, has_texture, record.color);
  find_opacity(material, &record);
  record.is_clamped = (uint32_t)is_clamped;
  if (!has_texture) {
    conic_assimp_send(w, record, NULL, 0);
    return;
  }
  const struct aiTexture *embedded = find_embedded(w->scene, path.data);
  if (embedded && embedded->mHeight)
    send_texels(w, record, embedded);
  else {
    record.picture = embedded ? CONIC_ASSIMP_FILE : CONIC_ASSIMP_PATH;
    conic_assimp_send(w, record, embedded ? (const void *)embedded->pcData : path.data,
                      embedded ? embedded->mWidth : strlen(path.data));
  }
}

uint32_t conic_assimp_material(conic_assimp_writer *w, const struct aiMesh *mesh) {
  if (mesh->mMaterialIndex >= w->scene->mNumMaterials)
    return UINT32_MAX;
  int64_t *sent = &w->sent[mesh->mMaterialIndex];
  if (*sent < 0) {
    send_material(w, w->scene->mMaterials[mesh->mMaterialIndex]);
    *sent = w->n_sent++;
  }
  return (uint32_t)*sent;
}

unsigned conic_assimp_coordinates(const conic_assimp_writer *w, const struct aiMesh *mesh) {
  struct aiString path;
  unsigned i = 0;
  int is_clamped;
  if (mesh->mMaterialIndex < w->scene->mNumMaterials)
    find_texture(w->scene->mMaterials[mesh->mMaterialIndex], &path, &i, &is_clamped);
  return i < AI_MAX_NUMBER_OF_TEXTURECOORDS && mesh->mTextureCoords[i] ? i : 0;
}
